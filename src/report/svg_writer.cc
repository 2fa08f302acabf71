#include "src/report/svg_writer.h"

#include <cctype>

#include "src/common/text.h"
#include "src/report/markup.h"
#include "src/report/page_files.h"

namespace alidade::internal {
namespace {

std::string Attribute(std::string_view name, std::string_view value) {
  return " " + std::string(name) + "=\"" + std::string(value) + "\"";
}

std::string Attribute(std::string_view name, double value) {
  return Attribute(name, SvgNumber(value));
}

std::string Class(std::string_view look) {
  return look.empty() ? "" : Attribute("class", look);
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

// The style of a file: every var(--name, value) by its value, since not all
// that draws SVG knows variables.
std::string FileStyle() {
  const std::string style = FigureStyle();
  std::string plain;
  std::size_t from = 0;
  for (std::size_t at = style.find("var("); at != std::string::npos;
       at = style.find("var(", from)) {
    const std::size_t value = style.find(", ", at) + 2;
    const std::size_t end = style.find(')', value);
    plain += style.substr(from, at - from) + style.substr(value, end - value);
    from = end + 1;
  }
  return plain + style.substr(from);
}

}  // namespace

std::string SvgNumber(double value) {
  std::string text = FixedNumber(value, 1);
  if (text.back() == '0') text.erase(text.size() - 2);
  return text;
}

double SvgTextWidth(std::string_view text, double size) {
  double width = 0.0;
  for (const char c : Typeset(text)) {
    width += CharacterWidth(static_cast<unsigned char>(c));
  }
  return width * size;
}

SvgWriter::SvgWriter(SvgPoint size, std::string_view title,
                     std::string_view description, FigureMedium medium) {
  const std::string width = SvgNumber(size.x);
  const std::string height = SvgNumber(size.y);
  document_ = "<svg" + Class("chart") +
              Attribute("viewBox", "0 0 " + width + " " + height) +
              Attribute("role", "img");
  if (medium == FigureMedium::kPage) {
    document_ += Attribute("tabindex", "0") +
                 Attribute("aria-label", Words(std::string(title) + ". " +
                                               std::string(description))) +
                 ">";
    return;
  }
  static const std::string* const kStyle = new std::string(FileStyle());
  document_ += Attribute("xmlns", "http://www.w3.org/2000/svg") +
               Attribute("width", width) + Attribute("height", height) +
               ">\n<title>" + Words(title) + "</title>\n<desc>" +
               Words(description) + "</desc>\n<style>" + *kStyle + "</style>\n";
  Box({0.0, 0.0, size.x, size.y}, "paper");
}

void SvgWriter::Box(const SvgBox& box, std::string_view look, double opacity) {
  document_ += "<rect" + Class(look) + Attribute("x", box.left) +
               Attribute("y", box.top) + Attribute("width", box.width) +
               Attribute("height", box.height);
  if (opacity < 1.0) {
    document_ += Attribute("fill-opacity", FixedNumber(opacity, 2));
  }
  document_ += "/>\n";
}

void SvgWriter::Line(SvgPoint from, SvgPoint to, std::string_view look) {
  document_ += "<line" + Class(look) + Attribute("x1", from.x) +
               Attribute("y1", from.y) + Attribute("x2", to.x) +
               Attribute("y2", to.y) + "/>\n";
}

void SvgWriter::Path(std::string_view data, std::string_view look,
                     double width) {
  document_ += "<path" + Class(look);
  if (width > 0.0) {
    document_ += Attribute("style", "stroke-width:" + SvgNumber(width));
  }
  document_ += Attribute("d", data) + "/>\n";
}

void SvgWriter::Strokes(std::string_view data, std::string_view colour,
                        double width) {
  document_ += "<path" + Attribute("stroke", colour) +
               Attribute("stroke-width", width) + Attribute("d", data) + "/>\n";
}

void SvgWriter::Layer(std::string_view name, std::string_view data,
                      std::string_view look, std::string_view colour) {
  document_ += "<path" + Class(look) + Attribute("data-layer", name);
  if (!colour.empty()) document_ += Attribute("stroke", colour);
  document_ += Attribute("d", data) + "/>\n";
}

void SvgWriter::BeginPart(std::string_view name, bool is_shown) {
  document_ += "<g" + Attribute("data-part", name);
  if (!is_shown) document_ += Attribute("display", "none");
  document_ += ">\n";
}

void SvgWriter::EndPart() { document_ += "</g>\n"; }

void SvgWriter::Text(SvgPoint position, std::string_view text,
                     std::string_view look, double turned) {
  const std::string x = SvgNumber(position.x);
  const std::string y = SvgNumber(position.y);
  document_ += "<text" + Class(look) + Attribute("x", x) + Attribute("y", y);
  if (turned != 0.0) {
    document_ += Attribute(
        "transform", "rotate(" + SvgNumber(turned) + " " + x + " " + y + ")");
  }
  document_ += ">" + Words(text) + "</text>\n";
}

void SvgWriter::Inside(SvgPoint corner, SvgPoint size,
                       std::string_view figure) {
  constexpr std::string_view kStart = "<svg";
  document_ += std::string(kStart) + Attribute("x", corner.x) +
               Attribute("y", corner.y) + Attribute("width", size.x) +
               Attribute("height", size.y) +
               std::string(figure.substr(kStart.size()));
}

void SvgWriter::Tip(SvgPoint position, std::string_view text) {
  // Line by line: a line's end counts as a space to CleanUtf8.
  std::string lines;
  for (std::size_t end = text.find('\n'); end != std::string_view::npos;
       end = text.find('\n')) {
    lines += Words(text.substr(0, end)) + "\n";
    text.remove_prefix(end + 1);
  }
  tips_ += "<circle" + Attribute("cx", position.x) +
           Attribute("cy", position.y) + "><title>" + lines + Words(text) +
           "</title></circle>\n";
}

std::string SvgWriter::Finish() {
  if (!tips_.empty()) document_ += "<g class=\"tips\">" + tips_ + "</g>";
  return document_ + "</svg>\n";
}

}  // namespace alidade::internal
