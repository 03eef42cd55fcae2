#include "apps/pictures/error_plot.hpp"

#include <stdexcept>

#include "apps/pictures/axis.hpp"
#include "apps/pictures/canvas.hpp"

namespace nearpose::pictures {
namespace {

constexpr int kWidth = 1000, kHeight = 680;
constexpr double kLeft = 92.0, kRight = 970.0;
constexpr Color kPaper{255, 255, 255}, kInk{40, 44, 52}, kGrid{226, 229, 234}, kFrame{150, 156, 166};
constexpr Color kTranslation{31, 110, 200}, kRotation{214, 92, 20}, kNoPose{250, 214, 214};
constexpr double kTextSize = 11.0;

struct Panel {
    double top, bottom;
    std::string label;  // of the curve, with its unit
    Color color;
    std::optional<double> ErrorPoint::*value;
};

double x_of(const Axis& frames, double frame) {
    return kLeft + frames.fraction(frame) * (kRight - kLeft);
}

double y_of(const Panel& panel, const Axis& values, double value) {
    return panel.bottom - values.fraction(value) * (panel.bottom - panel.top);
}

// Shades half a frame to both sides of every frame without a pose; true if there is one.
bool shade_missing(Canvas& canvas, const Panel& panel, const Axis& frames, const std::vector<ErrorPoint>& points) {
    bool any = false;
    for (const ErrorPoint& point : points) {
        if (point.*panel.value) continue;
        any = true;
        canvas.fill_rectangle(x_of(frames, point.frame_id - 0.5), panel.top, x_of(frames, point.frame_id + 0.5),
                              panel.bottom, kNoPose);
    }
    return any;
}

void draw_axes(Canvas& canvas, const Panel& panel, const Axis& frames, const Axis& values, bool label_frames) {
    for (const double tick : frames.ticks) {
        const double x = x_of(frames, tick);
        canvas.polyline({{x, panel.top}, {x, panel.bottom}}, 1.0, kGrid);
        if (label_frames) {
            canvas.text({x, panel.bottom + 20.0}, Axis::label(tick), kTextSize, kInk, Align::kCentre);
        }
    }
    for (const double tick : values.ticks) {
        const double y = y_of(panel, values, tick);
        canvas.polyline({{kLeft, y}, {kRight, y}}, 1.0, kGrid);
        canvas.text({kLeft - 10.0, y + 0.5 * kTextSize}, Axis::label(tick), kTextSize, kInk, Align::kRight);
    }
    canvas.polyline(
        {{kLeft, panel.top}, {kRight, panel.top}, {kRight, panel.bottom}, {kLeft, panel.bottom}, {kLeft, panel.top}},
        1.0, kFrame);
}

void draw_curve(Canvas& canvas, const Panel& panel, const Axis& frames, const Axis& values,
                const std::vector<ErrorPoint>& points) {
    std::vector<Eigen::Vector2d> run;  // frames with a pose, one after the other
    for (const ErrorPoint& point : points) {
        const std::optional<double>& value = point.*panel.value;
        if (value) run.emplace_back(x_of(frames, point.frame_id), y_of(panel, values, *value));
        if (value && points.size() <= 200) canvas.disc(run.back(), 3.0, panel.color);
        if (value) continue;
        canvas.polyline(run, 2.0, panel.color);
        run.clear();
    }
    canvas.polyline(run, 2.0, panel.color);
}

void draw_legend(Canvas& canvas, const Panel& panel, bool any_missing) {
    const std::string missing = "no pose";
    const double width = 46.0 + Canvas::text_width(panel.label, kTextSize);
    const double missing_width = any_missing ? 50.0 + Canvas::text_width(missing, kTextSize) : 0.0;
    double x = kRight - 14.0 - width - missing_width;
    const double y = panel.top + 20.0;
    canvas.fill_rectangle(x - 8.0, y - 13.0, kRight - 6.0, y + 13.0, kPaper, 0.85);
    canvas.polyline({{x, y}, {x + 30.0, y}}, 2.0, panel.color);
    canvas.disc({x + 15.0, y}, 3.0, panel.color);
    canvas.text({x + 40.0, y + 0.5 * kTextSize}, panel.label, kTextSize, kInk);
    if (!any_missing) return;
    x += width + 14.0;
    canvas.fill_rectangle(x, y - 7.0, x + 24.0, y + 7.0, kNoPose);
    canvas.text({x + 32.0, y + 0.5 * kTextSize}, missing, kTextSize, kInk);
}

void draw_panel(Canvas& canvas, const Panel& panel, const Axis& frames, const std::vector<ErrorPoint>& points,
                bool label_frames) {
    std::vector<double> present;
    for (const ErrorPoint& point : points) {
        if (point.*panel.value) present.push_back(*(point.*panel.value));
    }
    const Axis values = error_axis(present);
    const bool any_missing = shade_missing(canvas, panel, frames, points);
    draw_axes(canvas, panel, frames, values, label_frames);
    draw_curve(canvas, panel, frames, values, points);
    draw_legend(canvas, panel, any_missing);
}

}  // namespace

void write_error_plot(const std::filesystem::path& path, const std::string& title,
                      const std::vector<ErrorPoint>& points) {
    if (points.empty()) throw std::invalid_argument("write_error_plot: there are no points");
    Canvas canvas(kWidth, kHeight, kPaper);
    canvas.text({kLeft, 36.0}, title, 15.0, kInk);
    const Axis frames = frame_axis(points.front().frame_id, points.back().frame_id, 10);
    const Panel translation{60.0, 330.0, "translation error [mm]", kTranslation, &ErrorPoint::translation_mm};
    const Panel rotation{355.0, 625.0, "rotation error [deg]", kRotation, &ErrorPoint::rotation_deg};
    draw_panel(canvas, translation, frames, points, false);
    draw_panel(canvas, rotation, frames, points, true);
    canvas.text({0.5 * (kLeft + kRight), 668.0}, "frame", kTextSize, kInk, Align::kCentre);
    canvas.save(path);
}

}  // namespace nearpose::pictures
