"""What the results have that pages are tested with; made up."""

import math

HOSTILE = "<script>document.title='owned'</script></script><b>arm"


def free_parameters(result):
    return [p for p in result["parameters"] if p["state"] == "free"]


def add_uncertainty(result):
    """What a calibration with uncertainties has; made up, but for names."""
    result["arm"] = HOSTILE
    result["title"] = HOSTILE
    parameters = [{
        "name": p["name"], "std": 1e-5 * (i + 1), "nonlinearity": 0.0,
        "prior_share": 0.9 if i == 0 else 0.1,
        "interval": {"lower": p["value"] - 2e-5 * (i + 1),
                     "upper": p["value"] + 2e-5 * (i + 1), "profile": False},
    } for i, p in enumerate(free_parameters(result))]
    histogram = {"lower": -4.0, "width": 0.25, "counts": [
        round(100 * math.exp(-0.5 * (-3.875 + 0.25 * i) ** 2)) for i in range(32)]}
    summary = dict(result["accuracy"]["train"]["before"], median=1.25e-4)
    result["uncertainty"] = {
        "confidence": 0.95, "degrees_of_freedom": None,
        "estimator": "inverse information", "parameters": parameters,
        "covariance": [[0.0] * len(parameters)] * len(parameters),
        "correlated": [{"first": "d1", "second": "r2", "correlation": -0.97}],
        "residuals": {
            "chi_square": 150.0, "degrees_of_freedom": 151.0,
            "reduced_chi_square": 0.993, "chi_square_p_value": 0.51,
            "normality": {"statistic": 0.4, "p_value": 0.35},
            "whiteness": {"statistic": 9.0, "p_value": 0.5}, "lags": 10,
            "studentised_histogram": histogram},
        "workspace": {"position_std": summary, "rotation_std": summary},
        "validation": {
            "confidence": 0.95, "rms_z": 1.0, "verdict": "agree",
            "z_histogram": histogram,
            "axes": {"held": 95, "n": 100, "lower": 0.89, "upper": 0.98},
            "ellipsoids": {"held": 94, "n": 100, "lower": 0.87,
                           "upper": 0.97}},
        "warnings": ["a warning of uncertainty"],
    }


MAP_ROWS = ["q1_deg,x_mm,y_mm,z_mm,position_std_mm,true_error_mm"] + [
    f"0,{20 * i},{20 * j},{50 * k},{0.01 * (i + j + 1)},{0.02 * (k + 1)}"
    for i in range(10) for j in range(10) for k in range(5)]
