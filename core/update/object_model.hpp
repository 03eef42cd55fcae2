// What is known of the part before any image.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "core/options.hpp"
#include "core/search/pair_hypotheses.hpp"
#include "core/shape/modes.hpp"
#include "core/view_generator.hpp"

namespace nearpose {

// Made once, with all slow set-up, and never changed; several estimators may share one.
struct ObjectModel {
    std::shared_ptr<const ViewGenerator> views;
    std::vector<OrientedPoint> surface_points;  // for a search by single points
    std::optional<PointPairTable> point_pairs;  // for a search by pairs of points
    Symmetries symmetries;
    ModeDistance mode_distance;  // poses closer than that are one mode

    const ModelExtent& extent() const { return views->extent(); }
    Eigen::Vector3d centre_in_object() const { return extent().centre_in_object(); }
    double diameter_m() const { return extent().diameter_m(); }
    bool same_mode(const Pose& a, const Pose& b) const {
        return nearpose::same_mode(a, b, centre_in_object(), mode_distance);
    }
    std::vector<Mode> distinct(const std::vector<Mode>& modes, int max_count) const {
        return distinct_modes(modes, max_count, centre_in_object(), mode_distance);
    }
};

// Throws std::invalid_argument where there is no view generator.
ObjectModel make_object_model(std::shared_ptr<const ViewGenerator> views, const EstimatorOptions& options);

}  // namespace nearpose
