#ifndef ALIDADE_SRC_REPORT_SVG_WRITER_H_
#define ALIDADE_SRC_REPORT_SVG_WRITER_H_

#include <string>
#include <string_view>

namespace alidade::internal {

/// Where a figure is shown: as a file of its own, with its title and style, or
/// in a page, which has them.
enum class FigureMedium { kFile, kPage };

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

/// A coordinate in pixels with at most one decimal.
std::string SvgNumber(double value);

/// About how wide `text` is drawn, on the large side, since the font is the
/// reader's.
double SvgTextWidth(std::string_view text, double size);

/// Collects the elements of one figure. Coordinates are pixels, y downwards.
/// What an element looks like is said by classes of figures.css, so that the
/// same figure serves light, dark, paper and file. No identifiers are used, so
/// that figures can be pasted together into one page.
class SvgWriter {
 public:
  /// `title` and `description` are for screen readers.
  SvgWriter(SvgPoint size, std::string_view title, std::string_view description,
            FigureMedium medium);

  void Box(const SvgBox& box, std::string_view look, double opacity = 1.0);
  void Line(SvgPoint from, SvgPoint to, std::string_view look);
  /// `data` is a path's d attribute; a width of 0 is that of the look.
  void Path(std::string_view data, std::string_view look, double width = 0.0);
  /// A path stroked in a colour of its own, whatever the theme.
  void Strokes(std::string_view data, std::string_view colour, double width);
  /// A path that the page's script may draw anew, known by its name; in a
  /// colour of its own where one is given.
  void Layer(std::string_view name, std::string_view data,
             std::string_view look, std::string_view colour = "");
  /// What is shown or hidden together, known by its name.
  void BeginPart(std::string_view name, bool is_shown);
  void EndPart();
  /// Typeset. `position` is the anchor on the base line; `turned` in degrees.
  void Text(SvgPoint position, std::string_view text, std::string_view look,
            double turned = 0.0);
  /// A figure of a page, of this size, with its corner at `corner`.
  void Inside(SvgPoint corner, SvgPoint size, std::string_view figure);
  /// What is said under the pointer.
  void Tip(SvgPoint position, std::string_view text);

  /// The figure. The writer is done after that.
  std::string Finish();

 private:
  std::string document_;
  std::string tips_;
};

}  // namespace alidade::internal

#endif  // ALIDADE_SRC_REPORT_SVG_WRITER_H_
