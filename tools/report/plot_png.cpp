#include "libpreprocess/error.h"
#include "tools/report/plot.h"

#ifdef TET4D_WITH_CAIRO

#include <cairo.h>

#include <cstdlib>
#include <memory>

#include "tools/report/canvas.h"

namespace tet4d::report {
namespace {

struct FreeContext {
  void operator()(cairo_t* context) const { cairo_destroy(context); }
};
struct FreeSurface {
  void operator()(cairo_surface_t* surface) const { cairo_surface_destroy(surface); }
};

class CairoCanvas final : public Canvas {
 public:
  explicit CairoCanvas(cairo_t* context) : context_(context) {
    cairo_select_font_face(context_, "sans-serif", CAIRO_FONT_SLANT_NORMAL, CAIRO_FONT_WEIGHT_NORMAL);
  }
  void line(const std::vector<std::pair<double, double>>& points, const std::string& colour, double width) override {
    use(colour);
    cairo_set_line_width(context_, width);
    cairo_new_path(context_);  // text leaves a current point
    for (const auto& [x, y] : points) cairo_line_to(context_, x, y);
    cairo_stroke(context_);
  }
  void dot(double x, double y, double radius, const std::string& colour) override {
    use(colour);
    cairo_new_path(context_);
    cairo_arc(context_, x, y, radius, 0, 6.283185307179586);
    cairo_fill(context_);
  }
  void text(double x, double y, const std::string& text, Anchor anchor, double size, bool upwards) override {
    use("#333333");
    cairo_set_font_size(context_, size);
    cairo_text_extents_t extents;
    cairo_text_extents(context_, text.c_str(), &extents);
    const double part = anchor == Anchor::kStart ? 0 : anchor == Anchor::kMiddle ? 0.5 : 1;
    cairo_save(context_);
    cairo_translate(context_, x, y);
    if (upwards) cairo_rotate(context_, -1.5707963267948966);
    cairo_move_to(context_, -part * extents.x_advance, 0);
    cairo_show_text(context_, text.c_str());
    cairo_restore(context_);
  }

 private:
  void use(const std::string& colour) {
    const auto channel = [&](std::size_t at) {
      return static_cast<double>(std::strtoul(colour.substr(at, 2).c_str(), nullptr, 16)) / 255;
    };
    cairo_set_source_rgb(context_, channel(1), channel(3), channel(5));
  }

  cairo_t* context_;
};

}  // namespace

bool hasPng() { return true; }

void writePng(const Plot& plot, const std::string& path) {
  constexpr double kScale = 2;
  const std::unique_ptr<cairo_surface_t, FreeSurface> surface(cairo_image_surface_create(
      CAIRO_FORMAT_RGB24, static_cast<int>(kScale * kPlotWidth), static_cast<int>(kScale * kPlotHeight)));
  const std::unique_ptr<cairo_t, FreeContext> context(cairo_create(surface.get()));
  cairo_set_source_rgb(context.get(), 1, 1, 1);
  cairo_paint(context.get());
  cairo_scale(context.get(), kScale, kScale);
  CairoCanvas canvas(context.get());
  draw(plot, canvas);
  if (const cairo_status_t status = cairo_surface_write_to_png(surface.get(), path.c_str());
      status != CAIRO_STATUS_SUCCESS) {
    throw Error(FaultCode::kIo, path, "", std::string("cannot be written: ") + cairo_status_to_string(status), "");
  }
}

}  // namespace tet4d::report

#else

namespace tet4d::report {

bool hasPng() { return false; }

void writePng(const Plot&, const std::string& path) {
  throw Error(FaultCode::kNotBuilt, path, "", "this build draws no PNG plots",
              "build with -DTET4D_WITH_CAIRO=ON (Debian: libcairo2-dev); the SVG beside it is the same plot");
}

}  // namespace tet4d::report

#endif
