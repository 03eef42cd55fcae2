#include "core/update/object_model.hpp"

#include <stdexcept>
#include <utility>

namespace nearpose {

ObjectModel make_object_model(std::shared_ptr<const ViewGenerator> views, const EstimatorOptions& options) {
    if (!views) throw std::invalid_argument("PoseEstimator: a view generator is needed");
    ObjectModel model;
    model.views = std::move(views);
    if (options.method.search.initialisation == Initialisation::kSurface)
        model.surface_points = sample_surface(*model.views, options.method.search.surface_points);
    if (options.method.search.initialisation == Initialisation::kPairs)
        model.point_pairs.emplace(*model.views, options.method.search);
    model.symmetries = options.symmetries;
    model.mode_distance = {options.method.hypotheses.mode_rotation_rad,
                           options.method.hypotheses.mode_translation_diameters * model.diameter_m()};
    return model;
}

}  // namespace nearpose
