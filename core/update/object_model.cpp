#include "core/update/object_model.hpp"

#include <stdexcept>
#include <utility>

namespace nearpose {

ObjectModel make_object_model(std::shared_ptr<const ViewGenerator> views, const EstimatorOptions& options) {
    constexpr double kRotation_rad = 0.15;
    constexpr double kTranslationDiameters = 0.03;
    if (!views) throw std::invalid_argument("PoseEstimator: a view generator is needed");
    ObjectModel model;
    model.views = std::move(views);
    if (options.method.start == Start::kSurface) model.surface_points = find_anchors(*model.views);
    if (options.method.start == Start::kPairs) model.point_pairs.emplace(*model.views);
    model.symmetries = options.symmetries;
    model.mode_distance = {kRotation_rad, kTranslationDiameters * model.diameter_m()};
    return model;
}

}  // namespace nearpose
