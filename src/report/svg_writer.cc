#include "src/report/svg_writer.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <utility>

#include "src/common/text.h"

namespace alidade::internal {
namespace {

constexpr double kSuperscriptSize = 0.75;
constexpr double kSuperscriptRise = 0.38;
// A minus sign is wider than the hyphen that stands for it.
constexpr double kMinusWidth = 0.5;
constexpr double kSpaceWidth = 0.3;

constexpr std::string_view kFontFamily =
    "system-ui,-apple-system,'Segoe UI',Roboto,'Helvetica Neue',Arial,"
    "'Liberation Sans','DejaVu Sans',sans-serif";

std::string Attribute(std::string_view name, std::string_view value) {
  std::string text = " ";
  text += name;
  text += "=\"";
  text += value;
  text += "\"";
  return text;
}

std::string Attribute(std::string_view name, double value) {
  return Attribute(name, SvgNumber(value));
}

std::string StrokeAttributes(const SvgStroke& stroke) {
  std::string text = Attribute("stroke", stroke.colour) +
                     Attribute("stroke-width", stroke.width);
  if (!stroke.dashes.empty()) {
    text += Attribute("stroke-dasharray", stroke.dashes);
  }
  return text;
}

bool IsDigit(std::string_view text, std::size_t position) {
  return position < text.size() &&
         std::isdigit(static_cast<unsigned char>(text[position])) != 0;
}

// The exponent of the first "10^-13" in a text: where its "^" stands and where
// the number after it ends.
struct Power {
  std::size_t caret = std::string_view::npos;
  std::size_t end = std::string_view::npos;
};

Power FindPower(std::string_view text) {
  for (std::size_t at = text.find("10^"); at != std::string_view::npos;
       at = text.find("10^", at + 1)) {
    std::size_t end = at + 3;
    if (end < text.size() && text[end] == '-') ++end;
    if (!IsDigit(text, end)) continue;
    while (IsDigit(text, end)) ++end;
    return {at + 2, end};
  }
  return {};
}

std::string RaisedExponent(std::string_view exponent, double size) {
  std::string text = "<tspan" + Attribute("dy", -kSuperscriptRise * size) +
                     Attribute("font-size", kSuperscriptSize * size) + ">";
  if (exponent.front() == '-') {
    text += "\u2212";
    exponent.remove_prefix(1);
  }
  return text + std::string(exponent) + "</tspan>";
}

// The text after an exponent, back on the base line. Some renderers drop a
// space at the start of a tspan, so it becomes a shift.
std::string LoweredText(std::string_view text, double size) {
  std::string shift = Attribute("dy", kSuperscriptRise * size);
  for (const std::string_view space : {" ", "\u00a0"}) {
    if (text.substr(0, space.size()) != space) continue;
    text.remove_prefix(space.size());
    shift = Attribute("dx", kSpaceWidth * size) + shift;
  }
  return "<tspan" + shift + ">" + EscapeXml(text) + "</tspan>";
}

std::string RichText(std::string_view text, double size) {
  Power power = FindPower(text);
  std::string rich = EscapeXml(text.substr(0, power.caret));
  while (power.caret != std::string_view::npos) {
    rich += RaisedExponent(
        text.substr(power.caret + 1, power.end - power.caret - 1), size);
    text.remove_prefix(power.end);
    power = FindPower(text);
    if (!text.empty()) rich += LoweredText(text.substr(0, power.caret), size);
  }
  return rich;
}

std::string_view AnchorName(SvgText::Anchor anchor) {
  switch (anchor) {
    case SvgText::Anchor::kStart:
      return "start";
    case SvgText::Anchor::kMiddle:
      return "middle";
    case SvgText::Anchor::kEnd:
      return "end";
  }
  return "start";
}

// Widths in units of the font size, a little above those of Arial.
double CharacterWidth(unsigned char c) {
  if ((c & 0xC0U) == 0x80U) return 0.0;
  if (c >= 0xE3U) return 1.0;
  if (c >= 0x80U) return 0.6;
  if (std::string_view("fijlrtI.,:;'|!()[] -").find(static_cast<char>(c)) !=
      std::string_view::npos) {
    return 0.36;
  }
  if (std::string_view("mwMW@%").find(static_cast<char>(c)) !=
      std::string_view::npos) {
    return 0.9;
  }
  return std::isupper(c) != 0 ? 0.7 : 0.59;
}

}  // namespace

std::string EscapeXml(std::string_view text) {
  std::string escaped;
  for (const char c : CleanUtf8(text)) {
    switch (c) {
      case '&':
        escaped += "&amp;";
        break;
      case '<':
        escaped += "&lt;";
        break;
      case '>':
        escaped += "&gt;";
        break;
      case '"':
        escaped += "&quot;";
        break;
      case '\'':
        escaped += "&#39;";
        break;
      default:
        escaped += c;
    }
  }
  return escaped;
}

std::string SvgNumber(double value) {
  std::string text = FixedNumber(value, 2);
  while (text.back() == '0') text.pop_back();
  if (text.back() == '.') text.pop_back();
  return text.empty() ? "0" : text;
}

double SvgTextWidth(std::string_view text, double size) {
  const Power power = FindPower(text);
  if (power.caret != std::string_view::npos) {
    const std::string_view exponent =
        text.substr(power.caret + 1, power.end - power.caret - 1);
    return SvgTextWidth(text.substr(0, power.caret), size) +
           (SvgTextWidth(exponent, size) + kMinusWidth * size) *
               kSuperscriptSize +
           SvgTextWidth(text.substr(power.end), size);
  }
  double width = 0.0;
  for (const char c : text) {
    width += CharacterWidth(static_cast<unsigned char>(c));
  }
  return width * size;
}

SvgWriter::SvgWriter(SvgPoint size, std::string_view title,
                     std::string_view description) {
  const std::string width = SvgNumber(size.x);
  const std::string height = SvgNumber(size.y);
  document_ = "<svg" + Attribute("xmlns", "http://www.w3.org/2000/svg") +
              Attribute("width", width) + Attribute("height", height) +
              Attribute("viewBox", "0 0 " + width + " " + height) +
              Attribute("role", "img") + Attribute("font-family", kFontFamily) +
              ">\n";
  document_ += "<title>" + EscapeXml(title) + "</title>\n";
  document_ += "<desc>" + EscapeXml(description) + "</desc>\n";
  Box({0.0, 0.0, size.x, size.y}, "#ffffff");
}

void SvgWriter::Box(const SvgBox& box, std::string_view fill) {
  document_ += "<rect" + Attribute("x", box.left) + Attribute("y", box.top) +
               Attribute("width", box.width) + Attribute("height", box.height) +
               Attribute("fill", fill) + "/>\n";
}

void SvgWriter::Line(SvgPoint from, SvgPoint to, const SvgStroke& stroke) {
  document_ += "<line" + Attribute("x1", from.x) + Attribute("y1", from.y) +
               Attribute("x2", to.x) + Attribute("y2", to.y) +
               StrokeAttributes(stroke) + "/>\n";
}

void SvgWriter::Outline(std::string_view data, const SvgStroke& stroke) {
  document_ += "<path" + Attribute("fill", "none") + StrokeAttributes(stroke) +
               Attribute("stroke-linejoin", "round") +
               Attribute("stroke-linecap", "round") + Attribute("d", data) +
               "/>\n";
}

void SvgWriter::Strokes(std::string_view data, const SvgStroke& stroke) {
  document_ += "<path" + Attribute("fill", "none") + StrokeAttributes(stroke) +
               Attribute("d", data) + "/>\n";
}

void SvgWriter::Fill(std::string_view data, std::string_view colour) {
  document_ +=
      "<path" + Attribute("fill", colour) + Attribute("d", data) + "/>\n";
}

void SvgWriter::Marker(std::string_view data, std::string_view fill,
                       const SvgStroke& rim) {
  document_ += "<path" + Attribute("fill", fill) + StrokeAttributes(rim) +
               Attribute("d", data) + "/>\n";
}

void SvgWriter::Text(SvgPoint position, std::string_view text,
                     const SvgText& style) {
  document_ += "<text" + Attribute("x", position.x) +
               Attribute("y", position.y) + Attribute("font-size", style.size) +
               Attribute("fill", style.colour);
  if (style.anchor != SvgText::Anchor::kStart) {
    document_ += Attribute("text-anchor", AnchorName(style.anchor));
  }
  if (style.bold) document_ += Attribute("font-weight", "600");
  if (style.upwards) {
    document_ += Attribute("transform", "rotate(-90 " + SvgNumber(position.x) +
                                            " " + SvgNumber(position.y) + ")");
  }
  if (style.halo) {
    document_ += Attribute("stroke", "#ffffff") +
                 Attribute("stroke-width", 4.0) +
                 Attribute("stroke-linejoin", "round") +
                 Attribute("paint-order", "stroke");
  }
  document_ += ">" + RichText(text, style.size) + "</text>\n";
}

std::string SvgWriter::Finish() {
  document_ += "</svg>\n";
  return std::move(document_);
}

}  // namespace alidade::internal
