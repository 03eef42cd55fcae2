#include "apps/fit_sensor/edge_growth.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <stdexcept>

namespace nearpose::simulate {
namespace {

struct Pixel {
    int u = 0, v = 0;
};

constexpr std::array<Pixel, 4> kOutwards{{{-1, 0}, {1, 0}, {0, -1}, {0, 1}}};  // in the order of kSideNames

// The two images along a line that leaves the object; place 0 is the object's last pixel there.
struct Line {
    const DepthImage& measured;
    const DepthImage& exact;
    Pixel last;
    Pixel outwards;

    // Negative outside the image.
    double at(const DepthImage& image, int place) const {
        const int u = last.u + place * outwards.u, v = last.v + place * outwards.v;
        if (u < 0 || v < 0 || u >= image.width || v >= image.height) return -1.0;
        return image.depth_m[static_cast<std::size_t>(v) * image.width + u];
    }
    Line beside(int pixels) const {
        return {measured, exact, {last.u + pixels * outwards.v, last.v + pixels * outwards.u}, outwards};
    }
    bool ends_at(int place) const { return at(exact, place) > 0.0 && at(exact, place + 1) == 0.0; }
};

// Where the object ends on the line `pixels` beside this one, in places of this line.
std::optional<int> end_beside(const Line& line, int pixels) {
    const Line other = line.beside(pixels);
    const int most = std::abs(pixels) / 2;
    for (int place = -most; place <= most; ++place)
        if (other.ends_at(place)) return place;
    return std::nullopt;
}

// Cosine of the angle between the line and the normal of the edge; nullopt where the edge is not straight there.
std::optional<double> edge_cosine(const Line& line, int pixels) {
    const auto before = end_beside(line, -pixels), after = end_beside(line, pixels);
    if (!before || !after || std::abs(*before + *after) > 1) return std::nullopt;
    const double slope = 0.5 * (*after - *before) / pixels;
    return 1.0 / std::sqrt(1.0 + slope * slope);
}

// Median of the measured depths in first..last; nullopt where half of them are missing.
std::optional<double> median_depth(const Line& line, int first, int last) {
    std::vector<double> depths;
    for (int place = first; place <= last; ++place) {
        const double depth_m = line.at(line.measured, place);
        if (depth_m > 0.0) depths.push_back(depth_m);
    }
    if (2 * static_cast<int>(depths.size()) <= last - first) return std::nullopt;
    const auto middle = depths.begin() + static_cast<std::ptrdiff_t>(depths.size() / 2);
    std::nth_element(depths.begin(), middle, depths.end());
    return *middle;
}

// The object alone up to place 0, nothing of it beyond, and all of it in the image.
bool leaves_object(const Line& line, int reach) {
    for (int place = -reach; place <= 2 * reach; ++place) {
        const double depth_m = line.at(line.exact, place);
        if (place <= 0 ? depth_m <= 0.0 : depth_m != 0.0) return false;
    }
    return true;
}

// Depth at place 0 of the surface that is seen farther inside: of a plane the inverse depth is linear in the image. A
// flank that is seen at a grazing angle, a few pixels wide, departs from it.
double continued_depth(const Line& line) {
    return 1.0 / (2.0 / line.at(line.exact, -4) - 1.0 / line.at(line.exact, -8));
}

// Places from the object's true edge to the measured one: the cut with the fewest depths on the wrong side, so that
// noise moves it to neither side. nullopt where no depth is measured beside it.
std::optional<double> crossing(const Line& line, double middle_m, const EdgeOptions& options) {
    const int reach = options.reach_pixels;
    int near = 0, far = 0;
    for (int place = -reach; place <= reach; ++place) {
        const double depth_m = line.at(line.measured, place);
        if (depth_m > 0.0) ++(depth_m < middle_m ? near : far);
    }
    if (near == 0 || far == 0 || 2 * reach + 1 - near - far > options.max_missing_pixels) return std::nullopt;
    int wrong = near;  // with the cut before all places
    int fewest = wrong, first = -reach - 1, last = first;
    for (int cut = -reach; cut <= reach; ++cut) {
        const double depth_m = line.at(line.measured, cut);
        if (depth_m > 0.0) wrong += depth_m < middle_m ? -1 : 1;
        if (wrong < fewest) first = cut;
        if (wrong <= fewest) last = cut;
        fewest = std::min(fewest, wrong);
    }
    return 0.5 * (first + last);
}

// What is known of the edge at the end of a line.
struct Edge {
    bool is_step = false;
    std::optional<double> growth_pixels;
};

Edge edge_at(const Line& line, const EdgeOptions& options) {
    const int reach = options.reach_pixels;
    if (!line.ends_at(0) || !leaves_object(line, reach)) return {};
    const auto cosine = edge_cosine(line, options.straight_pixels);
    if (!cosine) return {};
    const double near_m = line.at(line.exact, 0), inside_m = line.at(line.exact, -3 * reach / 4);
    const auto measured_m = median_depth(line, -reach, -reach / 2), far_m = median_depth(line, reach + 1, 2 * reach);
    if (!measured_m) return {};
    const double step_m = far_m ? *far_m - near_m : options.least_step * near_m;
    if (step_m < options.least_step * near_m) return {};
    const double most_m = options.max_depth_error * step_m;
    if (std::abs(*measured_m - inside_m) > most_m || std::abs(near_m - continued_depth(line)) > most_m) return {};
    if (!far_m) return {true, std::nullopt};
    const auto places = crossing(line, near_m + 0.5 * step_m, options);
    return {true, places ? std::optional(*places * *cosine) : std::nullopt};
}

struct PlaceSum {
    int edges = 0;
    double sum = 0.0;
};

// The mean of all edges, with its interval where there are several places.
FittedFigure clustered_mean(const std::vector<PlaceSum>& places) {
    double edges = 0.0, sum = 0.0, squares = 0.0;
    for (const PlaceSum& place : places) {
        edges += place.edges;
        sum += place.sum;
    }
    const double mean = sum / edges, count = static_cast<double>(places.size());
    if (places.size() < 2) return {mean, mean, mean, false};
    for (const PlaceSum& place : places) {
        const double rest = place.sum - place.edges * mean;
        squares += rest * rest;
    }
    const double half = 1.96 * std::sqrt(squares * count / (count - 1.0)) / edges;
    return {mean, mean - half, mean + half, true};
}

FittedFigure mean_of(const FittedFigure& a, const FittedFigure& b) {
    if (!a.fitted || !b.fitted) return {};
    const double value = 0.5 * (a.value + b.value), half = 0.5 * std::hypot(a.high - a.value, b.high - b.value);
    return {value, value - half, value + half, true};
}

void add_notes(EdgeGrowth& growth) {
    constexpr int kFewPlaces = 10;
    for (std::size_t i = 0; i < growth.sides.size(); ++i) {
        const EdgeSide& side = growth.sides[i];
        const std::string name = kSideNames[i];
        if (side.edges == 0 || side.edges < side.without_depth)
            growth.notes.push_back("edge growth on the " + name + " side could not be determined: " +
                                   (side.without_depth > 0
                                        ? "most or all of the edge has no depth beside it, as in a shadow"
                                        : "no straight edge of the object stands before something farther"));
        else if (!side.growth_pixels.fitted || side.places < kFewPlaces)
            growth.notes.push_back("edge growth on the " + name + " side was seen in " + std::to_string(side.places) +
                                   " places of the image alone: its interval is rough, or missing for one place");
    }
    for (const bool rows : {true, false})
        if (!(rows ? growth.along_rows : growth.along_columns).fitted)
            growth.notes.push_back(std::string("opposite sides were not both measured along ") +
                                   (rows ? "rows" : "columns") + ": growth there cannot be told from a shifted pose");
}

}  // namespace

void EdgeMeter::add(const DepthImage& measured, const DepthImage& exact) {
    if (measured.width != exact.width || measured.height != exact.height)
        throw std::invalid_argument("EdgeMeter: the measured and the exact image differ in size");
    for (std::size_t i = 0; i < sides_.size(); ++i) {
        for (int v = 0; v < exact.height; ++v) {
            for (int u = 0; u < exact.width; ++u) {
                const Edge edge = edge_at({measured, exact, {u, v}, kOutwards[i]}, options_);
                if (!edge.is_step) continue;
                if (!edge.growth_pixels) {
                    ++sides_[i].without_depth;
                    continue;
                }
                Place& place = sides_[i].places[{u / options_.place_pixels, v / options_.place_pixels}];
                ++place.edges;
                place.sum_pixels += *edge.growth_pixels;
                place.square_sum += *edge.growth_pixels * *edge.growth_pixels;
            }
        }
    }
}

// The places' sums are taken for independent, not the edges in them.
EdgeSide EdgeMeter::side_growth(const Side& side) const {
    EdgeSide result;
    result.without_depth = side.without_depth;
    result.places = static_cast<int>(side.places.size());
    std::vector<PlaceSum> growth, squares;
    for (const auto& [where, place] : side.places) {
        result.edges += place.edges;
        growth.push_back({place.edges, place.sum_pixels});
    }
    if (result.edges == 0) return result;
    result.growth_pixels = clustered_mean(growth);
    // The few that are measured in a shadow are those where something went wrong.
    if (result.edges < result.without_depth) result.growth_pixels.fitted = false;
    const double mean = result.growth_pixels.value;
    for (const auto& [where, place] : side.places)
        squares.push_back({place.edges, place.square_sum - 2.0 * mean * place.sum_pixels + mean * mean * place.edges});
    const FittedFigure variance = clustered_mean(squares);
    const auto root = [](double value) { return std::sqrt(std::max(0.0, value)); };
    result.scatter_pixels = {root(variance.value), root(variance.low), root(variance.high),
                             variance.fitted && result.growth_pixels.fitted};
    return result;
}

EdgeGrowth EdgeMeter::growth() const {
    EdgeGrowth growth;
    for (std::size_t i = 0; i < sides_.size(); ++i) growth.sides[i] = side_growth(sides_[i]);
    growth.along_rows = mean_of(growth.sides[0].growth_pixels, growth.sides[1].growth_pixels);
    growth.along_columns = mean_of(growth.sides[2].growth_pixels, growth.sides[3].growth_pixels);
    add_notes(growth);
    return growth;
}

}  // namespace nearpose::simulate
