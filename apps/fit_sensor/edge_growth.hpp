// By how much near surfaces grow over what is behind them: the edges of measured depth beside those of an object at its
// true pose. A matcher gives one depth for a window, and at a depth step that is often the nearer one.
#pragma once

#include <array>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "apps/fit_sensor/sensor_fit.hpp"
#include "core/base/camera.hpp"
#include "core/base/depth_image.hpp"

namespace nearpose::simulate {

struct EdgeOptions {
    int reach_pixels = 12;       // looked at on both sides of an edge; larger growth is not found
    double least_step = 0.05;    // from the object to what is behind it, of the object's depth
    int max_missing_pixels = 3;  // without depth within the reach; more are a shadow, which has no edge to measure
    int straight_pixels = 4;     // to both sides along the edge it is straight, and at most as steep as 1 : 2
    int place_pixels = 16;       // edges in a square of so many count as one for the interval: they share their errors
    double max_depth_error = 0.2;  // of the object inside its edge, as part of the step: else it is hidden or bent
};

// One side of the object in the image.
struct EdgeSide {
    // Mean, across the edge; positive: the object is measured too large. `fitted` where there are several places, and
    // no more pixels without depth than edges.
    FittedFigure growth_pixels;
    FittedFigure scatter_pixels;  // standard deviation of single pixels of the edge about that mean
    int edges = 0;                // pixels of the edge, over all frames, that were measured
    int without_depth = 0;        // pixels of the edge without depth beside them, as in a shadow
    int places = 0;               // that count as independent
};

struct EdgeGrowth {
    std::array<EdgeSide, 4> sides;  // left, right, upper, lower
    // Means of opposite sides: what the pose is shifted by in the image cancels. `fitted` where both were measured.
    FittedFigure along_rows, along_columns;
    std::vector<std::string> notes;  // what could not be determined
};

inline constexpr std::array<const char*, 4> kSideNames{"left", "right", "upper", "lower"};

class EdgeMeter {
  public:
    explicit EdgeMeter(const EdgeOptions& options = {}) : options_(options) {}

    // `exact`: the object alone at its true pose [m], 0 beside it. Throws std::invalid_argument where the images differ
    // in size.
    void add(const DepthImage& measured, const DepthImage& exact);

    EdgeGrowth growth() const;

  private:
    struct Place {
        int edges = 0;
        double sum_pixels = 0.0, square_sum = 0.0;
    };
    struct Side {
        std::map<std::pair<int, int>, Place> places;
        int without_depth = 0;
    };

    EdgeSide side_growth(const Side& side) const;

    EdgeOptions options_;
    std::array<Side, 4> sides_;
};

}  // namespace nearpose::simulate
