#include "apps/pictures/error_plot.hpp"

#include <stdexcept>

#include "apps/pictures/axis.hpp"
#include "apps/pictures/canvas.hpp"

namespace nearpose::pictures {
namespace {

constexpr int kSheetWidth = 1000, kSheetHeight = 680;
constexpr double kSheetLeft = 92.0, kSheetRight = 970.0;
constexpr Color kSheetPaper{255, 255, 255}, kSheetInk{40, 44, 52}, kSheetGrid{226, 229, 234},
    kSheetFrame{150, 156, 166};
constexpr Color kTranslation{31, 110, 200}, kRotation{214, 92, 20}, kNoPose{250, 214, 214};
constexpr double kSheetTextSize = 11.0;

struct ErrorPanel {
    double top, bottom;
    std::string label;  // of the curve, with its unit
    Color color;
    std::optional<double> ErrorPoint::*value;
};

double sheet_x(const Axis& frames, double frame) {
    return kSheetLeft + frames.fraction(frame) * (kSheetRight - kSheetLeft);
}

double sheet_y(const ErrorPanel& panel, const Axis& values, double value) {
    return panel.bottom - values.fraction(value) * (panel.bottom - panel.top);
}

// Shades half a frame to both sides of every frame without a pose; true if there is one.
bool shade_missing(Canvas& canvas, const ErrorPanel& panel, const Axis& frames, const std::vector<ErrorPoint>& points) {
    bool any = false;
    for (const ErrorPoint& point : points) {
        if (point.*panel.value) continue;
        any = true;
        canvas.fill_rectangle(sheet_x(frames, point.frame_id - 0.5), panel.top, sheet_x(frames, point.frame_id + 0.5),
                              panel.bottom, kNoPose);
    }
    return any;
}

void draw_error_axes(Canvas& canvas, const ErrorPanel& panel, const Axis& frames, const Axis& values,
                     bool label_frames) {
    for (const double tick : frames.ticks) {
        const double x = sheet_x(frames, tick);
        canvas.polyline({{x, panel.top}, {x, panel.bottom}}, 1.0, kSheetGrid);
        if (label_frames) {
            canvas.text({x, panel.bottom + 20.0}, Axis::label(tick), kSheetTextSize, kSheetInk, Align::kCentre);
        }
    }
    for (const double tick : values.ticks) {
        const double y = sheet_y(panel, values, tick);
        canvas.polyline({{kSheetLeft, y}, {kSheetRight, y}}, 1.0, kSheetGrid);
        canvas.text({kSheetLeft - 10.0, y + 0.5 * kSheetTextSize}, Axis::label(tick), kSheetTextSize, kSheetInk,
                    Align::kRight);
    }
    canvas.polyline({{kSheetLeft, panel.top},
                     {kSheetRight, panel.top},
                     {kSheetRight, panel.bottom},
                     {kSheetLeft, panel.bottom},
                     {kSheetLeft, panel.top}},
                    1.0, kSheetFrame);
}

void draw_error_curve(Canvas& canvas, const ErrorPanel& panel, const Axis& frames, const Axis& values,
                      const std::vector<ErrorPoint>& points) {
    std::vector<Eigen::Vector2d> run;  // frames with a pose, one after the other
    for (const ErrorPoint& point : points) {
        const std::optional<double>& value = point.*panel.value;
        if (value) run.emplace_back(sheet_x(frames, point.frame_id), sheet_y(panel, values, *value));
        if (value && points.size() <= 200) canvas.disc(run.back(), 3.0, panel.color);
        if (value) continue;
        canvas.polyline(run, 2.0, panel.color);
        run.clear();
    }
    canvas.polyline(run, 2.0, panel.color);
}

void draw_error_legend(Canvas& canvas, const ErrorPanel& panel, bool any_missing) {
    const std::string missing = "no pose";
    const double width = 46.0 + Canvas::text_width(panel.label, kSheetTextSize);
    const double missing_width = any_missing ? 50.0 + Canvas::text_width(missing, kSheetTextSize) : 0.0;
    double x = kSheetRight - 14.0 - width - missing_width;
    const double y = panel.top + 20.0;
    canvas.fill_rectangle(x - 8.0, y - 13.0, kSheetRight - 6.0, y + 13.0, kSheetPaper, 0.85);
    canvas.polyline({{x, y}, {x + 30.0, y}}, 2.0, panel.color);
    canvas.disc({x + 15.0, y}, 3.0, panel.color);
    canvas.text({x + 40.0, y + 0.5 * kSheetTextSize}, panel.label, kSheetTextSize, kSheetInk);
    if (!any_missing) return;
    x += width + 14.0;
    canvas.fill_rectangle(x, y - 7.0, x + 24.0, y + 7.0, kNoPose);
    canvas.text({x + 32.0, y + 0.5 * kSheetTextSize}, missing, kSheetTextSize, kSheetInk);
}

void draw_error_panel(Canvas& canvas, const ErrorPanel& panel, const Axis& frames,
                      const std::vector<ErrorPoint>& points, bool label_frames) {
    std::vector<double> present;
    for (const ErrorPoint& point : points) {
        if (point.*panel.value) present.push_back(*(point.*panel.value));
    }
    const Axis values = error_axis(present);
    const bool any_missing = shade_missing(canvas, panel, frames, points);
    draw_error_axes(canvas, panel, frames, values, label_frames);
    draw_error_curve(canvas, panel, frames, values, points);
    draw_error_legend(canvas, panel, any_missing);
}

}  // namespace

void write_error_plot(const std::filesystem::path& path, const std::string& title,
                      const std::vector<ErrorPoint>& points) {
    if (points.empty()) throw std::invalid_argument("write_error_plot: there are no points");
    Canvas canvas(kSheetWidth, kSheetHeight, kSheetPaper);
    canvas.text({kSheetLeft, 36.0}, title, 15.0, kSheetInk);
    const Axis frames = frame_axis(points.front().frame_id, points.back().frame_id, 10);
    const ErrorPanel translation{60.0, 330.0, "translation error [mm]", kTranslation, &ErrorPoint::translation_mm};
    const ErrorPanel rotation{355.0, 625.0, "rotation error [deg]", kRotation, &ErrorPoint::rotation_deg};
    draw_error_panel(canvas, translation, frames, points, false);
    draw_error_panel(canvas, rotation, frames, points, true);
    canvas.text({0.5 * (kSheetLeft + kSheetRight), 668.0}, "frame", kSheetTextSize, kSheetInk, Align::kCentre);
    canvas.save(path);
}

}  // namespace nearpose::pictures
