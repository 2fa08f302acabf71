#ifndef ALIDADE_SRC_REPORT_SVG_WRITER_H_
#define ALIDADE_SRC_REPORT_SVG_WRITER_H_

#include <string>
#include <string_view>

namespace alidade::internal {

struct SvgPoint {
  double x = 0.0;
  double y = 0.0;
};

struct SvgBox {
  double left = 0.0;
  double top = 0.0;
  double width = 0.0;
  double height = 0.0;

  double right() const { return left + width; }
  double bottom() const { return top + height; }
};

struct SvgStroke {
  std::string_view colour = "#333333";
  double width = 1.0;
  std::string_view dashes = "";  ///< "6 4"; empty = solid
};

struct SvgText {
  enum class Anchor { kStart, kMiddle, kEnd };
  double size = 13.0;
  Anchor anchor = Anchor::kStart;
  std::string_view colour = "#333333";
  bool bold = false;
  bool upwards = false;  ///< turned by -90 degrees about its anchor
  bool halo = false;     ///< a white rim that keeps it readable on lines
};

/// `text` for character data and attributes of XML: markup characters
/// escaped, what is not valid in a document replaced.
std::string EscapeXml(std::string_view text);

/// A coordinate in pixels with at most two decimals and no trailing zeros.
std::string SvgNumber(double value);

/// About how wide `text` is drawn, on the large side, since the font is the
/// reader's.
double SvgTextWidth(std::string_view text, double size);

/// Collects the elements of one SVG document. Coordinates are pixels, y
/// downwards. Uses no identifiers, so that documents can be pasted together
/// into one page.
class SvgWriter {
 public:
  /// White background; `title` and `description` are for screen readers.
  SvgWriter(SvgPoint size, std::string_view title,
            std::string_view description);

  void Box(const SvgBox& box, std::string_view fill);
  void Line(SvgPoint from, SvgPoint to, const SvgStroke& stroke);
  /// `data` is a path's d attribute. Lines end and meet round.
  void Outline(std::string_view data, const SvgStroke& stroke);
  /// The same with straight ends.
  void Strokes(std::string_view data, const SvgStroke& stroke);
  void Fill(std::string_view data, std::string_view colour);
  /// A filled path with a rim.
  void Marker(std::string_view data, std::string_view fill,
              const SvgStroke& rim);
  /// Powers of ten written 10^-13 are set with a superscript. `position` is
  /// the anchor on the base line.
  void Text(SvgPoint position, std::string_view text, const SvgText& style);

  /// The document. The writer is done after that.
  std::string Finish();

 private:
  std::string document_;
};

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_REPORT_SVG_WRITER_H_
