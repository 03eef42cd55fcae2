#include "apps/pictures/curve_plot.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "apps/pictures/axis.hpp"
#include "apps/pictures/canvas.hpp"

namespace nearpose::pictures {
namespace {

using evaluation::Curve;
using evaluation::CurveBin;

constexpr int kWidth = 900;
constexpr double kLeft = 104.0, kRight = 866.0;
constexpr double kTitleHeight = 44.0, kPanelHeight = 260.0, kFootHeight = 62.0;
constexpr double kPlotHeight = kTitleHeight + kPanelHeight + kFootHeight;
constexpr double kTextSize = 11.0, kTitleSize = 13.0;
constexpr Color kPaper{255, 255, 255}, kInk{40, 44, 52}, kGrid{228, 231, 236}, kFrame{150, 156, 166},
    kTarget{120, 170, 60};

// Told apart by colour-blind readers (Okabe and Ito 2008), those that stand out on white first.
constexpr std::array kCurveColors = {Color{0, 114, 178},  Color{213, 94, 0},  Color{0, 158, 115}, Color{204, 121, 167},
                                     Color{86, 180, 233}, Color{230, 159, 0}, Color{60, 60, 60},  Color{150, 110, 60}};

Color color_of(std::size_t curve) {
    return kCurveColors[curve % kCurveColors.size()];
}

struct Panel {
    double top, bottom;
    Axis x, y;

    Eigen::Vector2d at(double x_value, double y_value) const {
        return {kLeft + x.fraction(x_value) * (kRight - kLeft), bottom - y.fraction(y_value) * (bottom - top)};
    }
};

bool has_bins(const CurvePlot& plot) {
    return std::any_of(plot.curves.begin(), plot.curves.end(), [](const Curve& curve) { return !curve.bins.empty(); });
}

Axis x_axis(const CurvePlot& plot) {
    double low = std::numeric_limits<double>::infinity(), high = -low;
    for (const Curve& curve : plot.curves) {
        for (const CurveBin& bin : curve.bins) {
            low = std::min(low, bin.x);
            high = std::max(high, bin.x);
        }
    }
    if (plot.x_logarithmic) return ratio_axis(low, high);
    const double margin = high > low ? 0.0 : std::max(std::abs(low) * 0.1, 1e-6);  // a single place: in the middle
    return round_axis(low - margin, high + margin, 10);
}

Panel panel_of(const CurvePlot& plot, double top) {
    const double panel_top = top + kTitleHeight, bottom = panel_top + kPanelHeight;
    if (plot.is_share_of_share) return {panel_top, bottom, round_axis(0.0, 1.0, 10), round_axis(0.0, 1.0, 5)};
    if (plot.y_is_share) return {panel_top, bottom, x_axis(plot), round_axis(0.0, 1.0, 5)};
    std::vector<double> drawn;
    for (const Curve& curve : plot.curves) {
        for (const CurveBin& bin : curve.bins) {
            drawn.insert(drawn.end(), {bin.median, bin.percentile_25, bin.percentile_75});
        }
    }
    return {panel_top, bottom, x_axis(plot), error_axis(drawn)};
}

void draw_axes(Canvas& canvas, const Panel& panel) {
    for (const double tick : panel.x.ticks) {
        const double x = panel.at(tick, panel.y.low).x();
        canvas.polyline({{x, panel.top}, {x, panel.bottom}}, 1.0, kGrid);
        canvas.text({x, panel.bottom + 20.0}, Axis::label(tick), kTextSize, kInk, Align::kCentre);
    }
    for (const double tick : panel.y.ticks) {
        const double y = panel.at(panel.x.low, tick).y();
        canvas.polyline({{kLeft, y}, {kRight, y}}, 1.0, kGrid);
        canvas.text({kLeft - 10.0, y + 0.5 * kTextSize}, Axis::label(tick), kTextSize, kInk, Align::kRight);
    }
    canvas.polyline(
        {{kLeft, panel.top}, {kRight, panel.top}, {kRight, panel.bottom}, {kLeft, panel.bottom}, {kLeft, panel.top}},
        1.0, kFrame);
}

// Between the quarters, as one area: seams would show in several.
void draw_band(Canvas& canvas, const Panel& panel, const Curve& curve, Color color) {
    constexpr double kOpacity = 0.2;
    if (curve.bins.size() < 2) return;
    std::vector<Eigen::Vector2d> outline;
    for (const CurveBin& bin : curve.bins) outline.push_back(panel.at(bin.x, bin.percentile_25));
    for (auto bin = curve.bins.rbegin(); bin != curve.bins.rend(); ++bin) {
        outline.push_back(panel.at(bin->x, bin->percentile_75));
    }
    canvas.fill_polygon(outline, color, kOpacity);
}

void draw_curve(Canvas& canvas, const Panel& panel, const Curve& curve, Color color) {
    std::vector<Eigen::Vector2d> line;
    for (const CurveBin& bin : curve.bins) line.push_back(panel.at(bin.x, bin.median));
    canvas.polyline(line, 2.2, color);
    constexpr std::size_t kMostMarks = 25;
    if (line.size() > kMostMarks) return;
    for (const Eigen::Vector2d& point : line) canvas.disc(point, 3.2, color);
}

bool is_of_shares(const CurvePlot& plot) {
    return plot.is_share_of_share || plot.y_is_share;
}

bool has_target(const CurvePlot& plot) {
    return plot.target.high > plot.target.low;
}

constexpr double kTargetOpacity = 0.22;

// Where the curves should run.
void draw_target(Canvas& canvas, const Panel& panel, const CurvePlot& plot) {
    if (has_target(plot)) {
        canvas.fill_rectangle(kLeft, panel.at(panel.x.low, plot.target.high).y(), kRight,
                              panel.at(panel.x.low, plot.target.low).y(), kTarget, kTargetOpacity);
    }
    for (std::size_t i = 0; i < plot.nominal.size(); ++i) {
        const double y = panel.at(panel.x.low, plot.nominal[i]).y();
        canvas.polyline({{kLeft, y}, {kRight, y}}, 1.2, color_of(i), 0.6);
    }
}

bool has_band(const Curve& curve) {
    return std::any_of(curve.bins.begin(), curve.bins.end(),
                       [](const CurveBin& bin) { return bin.percentile_75 > bin.percentile_25; });
}

// Where in the panel curves leave the most room: the corner with the fewest of their points.
Eigen::Vector2d legend_corner(const Panel& panel, const CurvePlot& plot, double width, double height) {
    constexpr double kMargin = 10.0;
    std::array<Eigen::Vector2d, 4> corners = {
        Eigen::Vector2d(kRight - width - kMargin, panel.top + kMargin),
        Eigen::Vector2d(kLeft + kMargin, panel.top + kMargin),
        Eigen::Vector2d(kRight - width - kMargin, panel.bottom - height - kMargin),
        Eigen::Vector2d(kLeft + kMargin, panel.bottom - height - kMargin)};
    const auto covered = [&](const Eigen::Vector2d& corner) {
        int count = 0;
        for (const Curve& curve : plot.curves) {
            for (const CurveBin& bin : curve.bins) {
                for (const double y : {bin.median, bin.percentile_25, bin.percentile_75}) {
                    const Eigen::Vector2d inside = panel.at(bin.x, y) - corner;
                    if (inside.x() > -12.0 && inside.y() > -12.0 && inside.x() < width + 12.0 &&
                        inside.y() < height + 12.0) {
                        ++count;
                    }
                }
            }
        }
        return count;
    };
    return *std::min_element(corners.begin(), corners.end(),
                             [&](const auto& a, const auto& b) { return covered(a) < covered(b); });
}

constexpr double kLegendLine = 21.0, kLegendSample = 30.0;

struct Legend {
    bool beside = false;  // to the right of the panel: more lines than that would hide curves
    std::string band;     // what the bands are; empty where there is none
    double width = 0.0, height = 0.0;
};

Legend legend_of(const CurvePlot& plot) {
    constexpr std::size_t kMostInside = 4;
    Legend legend;
    legend.beside = plot.curves.size() > kMostInside;
    if (std::any_of(plot.curves.begin(), plot.curves.end(), has_band))
        legend.band = is_of_shares(plot) ? "95 % interval" : "middle half of the frames";
    if (plot.y_is_share && !legend.band.empty()) legend.band += ", " + plot.curves.front().label;
    double widest = Canvas::text_width(legend.band, kTextSize);
    if (has_target(plot)) widest = std::max(widest, Canvas::text_width(plot.target.label, kTextSize));
    for (const Curve& curve : plot.curves) widest = std::max(widest, Canvas::text_width(curve.label, kTextSize));
    legend.width = kLegendSample + widest + 30.0;
    const std::size_t lines = plot.curves.size() + (legend.band.empty() ? 0 : 1) + (has_target(plot) ? 1 : 0);
    legend.height = kLegendLine * static_cast<double>(lines) + 8.0;
    return legend;
}

void draw_legend(Canvas& canvas, const Panel& panel, const CurvePlot& plot) {
    const Legend legend = legend_of(plot);
    const Eigen::Vector2d corner = legend.beside ? Eigen::Vector2d(kRight + 8.0, panel.top)
                                                 : legend_corner(panel, plot, legend.width, legend.height);
    canvas.fill_rectangle(corner.x(), corner.y(), corner.x() + legend.width, corner.y() + legend.height, kPaper, 0.88);
    Eigen::Vector2d at(corner.x() + 10.0, corner.y() + 15.0);
    const auto text_at = [&] { return Eigen::Vector2d(at.x() + kLegendSample + 10.0, at.y() + 0.5 * kTextSize); };
    for (std::size_t i = 0; i < plot.curves.size(); ++i, at.y() += kLegendLine) {
        canvas.polyline({at, {at.x() + kLegendSample, at.y()}}, 2.2, color_of(i));
        canvas.text(text_at(), plot.curves[i].label, kTextSize, kInk);
    }
    const auto area = [&](Color color, const std::string& text) {
        canvas.fill_rectangle(at.x(), at.y() - 7.0, at.x() + kLegendSample, at.y() + 7.0, color, 0.25);
        canvas.text(text_at(), text, kTextSize, kInk);
        at.y() += kLegendLine;
    };
    if (!legend.band.empty()) area(plot.curves.size() == 1 || is_of_shares(plot) ? color_of(0) : kFrame, legend.band);
    if (has_target(plot)) area(kTarget, plot.target.label);
}

void draw_plot(Canvas& canvas, const CurvePlot& plot, double top) {
    const Panel panel = panel_of(plot, top);
    canvas.text({kLeft, top + 26.0}, plot.title, kTitleSize, kInk);
    draw_axes(canvas, panel);
    canvas.vertical_text({30.0, 0.5 * (panel.top + panel.bottom)}, plot.y_title, kTextSize, kInk);
    canvas.text({0.5 * (kLeft + kRight), panel.bottom + 44.0}, plot.x_title, kTextSize, kInk, Align::kCentre);
    if (plot.is_share_of_share) canvas.polyline({panel.at(0.0, 0.0), panel.at(1.0, 1.0)}, 1.4, kFrame);
    draw_target(canvas, panel, plot);
    for (std::size_t i = 0; i < plot.curves.size(); ++i) draw_band(canvas, panel, plot.curves[i], color_of(i));
    for (std::size_t i = 0; i < plot.curves.size(); ++i) draw_curve(canvas, panel, plot.curves[i], color_of(i));
    draw_legend(canvas, panel, plot);
}

}  // namespace

void write_curve_plots(const std::filesystem::path& path, const std::vector<CurvePlot>& plots) {
    std::vector<CurvePlot> drawn;
    for (const CurvePlot& plot : plots) {
        if (has_bins(plot)) drawn.push_back(plot);
    }
    if (drawn.empty()) throw std::invalid_argument("write_curve_plots: there is no curve with a bin");
    double beside = 0.0;  // what the legends need to the right of the panels
    for (const CurvePlot& plot : drawn) {
        const Legend legend = legend_of(plot);
        if (legend.beside) beside = std::max(beside, legend.width);
    }
    Canvas canvas(kWidth + static_cast<int>(beside),
                  static_cast<int>(kPlotHeight * static_cast<double>(drawn.size())) + 10, kPaper);
    for (std::size_t i = 0; i < drawn.size(); ++i) draw_plot(canvas, drawn[i], kPlotHeight * static_cast<double>(i));
    canvas.save(path);
}

}  // namespace nearpose::pictures
