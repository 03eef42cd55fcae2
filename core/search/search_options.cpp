#include "core/search/search_options.hpp"

#include "core/base/check.hpp"

namespace nearpose {

void validate(const SurfaceViewOptions& options, const std::string& name) {
    check_option(name + ".directions", options.directions, 1, 1e5);
    check_option(name + ".side_pixels", options.side_pixels, 2, 4096);
    check_option(name + ".distance_diameters", options.distance_diameters, 0.6, 100.0);  // outside of the model
    check_option(name + ".focal_sides", options.focal_sides, 0.01, 1000.0);
}

void validate(const SurfacePointOptions& options, const std::string& name) {
    validate(options.views, name + ".views");
    check_option(name + ".count", options.count, 1, 1e7);
}

void validate(const ClosestPointGridOptions& options, const std::string& name) {
    validate(options.views, name + ".views");
    check_option(name + ".voxel_diameters", options.voxel_diameters, 0.005, 1.0);  // finer takes too much memory
    check_option(name + ".reach_voxels", options.reach_voxels, 1, 100);
}

void validate(const LargestFaceOptions& options, const std::string& name) {
    check_option(name + ".tolerance_diameters", options.tolerance_diameters, 0.0, 1.0);
    check_option(name + ".points", options.points, 3, 1e6);
    check_option(name + ".planes", options.planes, 0, 1e6);
}

void validate(const PointPairTableOptions& options, const std::string& name) {
    check_option(name + ".min_distance_diameters", options.min_distance_diameters, 1e-3, 1.0);
    check_option(name + ".max_distance_diameters", options.max_distance_diameters,
                 options.min_distance_diameters + 1e-3, 2.0);
    check_option(name + ".distance_cells", options.distance_cells, 1, 1000);
    check_option(name + ".angle_cells", options.angle_cells, 1,
                 25);  // more would be narrower than a bin of AngleCells
    check_option(name + ".max_points", options.max_points, 2, 1e5);
    validate(options.face, name + ".face");
}

void validate(const SurfelOptions& options, const std::string& name) {
    check_option(name + ".count", options.count, 1, 1e7);
    check_option(name + ".reach_min_distances", options.reach_min_distances, 0.0, 10.0);
    check_option(name + ".min_reach_pixels", options.min_reach_pixels, 1, 1000);
    check_option(name + ".max_reach_pixels", options.max_reach_pixels, options.min_reach_pixels, 1000);
    check_option(name + ".window_half", options.window_half, 1, 100);
    check_option(name + ".window_depth_reaches", options.window_depth_reaches, 0.0, 1e3);
    check_option(name + ".min_samples", options.min_samples, 3, 1e4);
    check_option(name + ".plane_sigmas", options.plane_sigmas, 0.0, 1e3);
    check_option(name + ".plane_reaches", options.plane_reaches, 0.0, 1e3);
    check_option(name + ".normal_fits", options.normal_fits, 0, 100);
    check_option(name + ".planes", options.planes, 0, 100);
    check_option(name + ".min_plane_share", options.min_plane_share, 0.0, 1.0);
    check_option(name + ".plane_points", options.plane_points, 3, 1e6);
    check_option(name + ".plane_draws", options.plane_draws, 0, 1e6);
    check_option(name + ".plane_fits", options.plane_fits, 0, 100);
}

void validate(const InlierOptions& options, const std::string& name) {
    check_option(name + ".min_normal_cosine", options.min_normal_cosine, -1.0, 1.0);
    check_option(name + ".max_distance_tolerances", options.max_distance_tolerances, 0.0, 1e3);
    check_option(name + ".max_depth_tolerances", options.max_depth_tolerances, 0.0, 1e3);
}

void validate(const AlignmentOptions& options, const std::string& name) {
    check_option(name + ".min_normal_cosine", options.min_normal_cosine, -1.0, 1.0);
    check_option(name + ".gate_tolerances", options.gate_tolerances, 0.0, 1e3);
    check_option(name + ".damping_points", options.damping_points, 1e-6, 1e6);
    check_option(name + ".scale_reaches", options.scale_reaches, 1e-3, 1e3);
}

void validate(const PruningOptions& options, const std::string& name) {
    check_option(name + ".first_points", options.first_points, 1, 1e6);
    check_option(name + ".first_model_points", options.first_model_points, 0, 1e6);
    check_option(name + ".coarse_points", options.coarse_points, 1, 1e6);
    check_option(name + ".coarse_model_points", options.coarse_model_points, 0, 1e6);
    check_option(name + ".coarse_tolerances", options.coarse_tolerances, 0.0, 1e3);
    for (std::size_t k = 0; k < options.stages.size(); ++k) {
        const std::string stage = name + ".stages[" + std::to_string(k) + "]";
        check_option(stage + ".kept", options.stages[k].kept, 1, 1e7);
        check_option(stage + ".alignment_rounds", options.stages[k].alignment_rounds, 0, 1000);
        check_option(stage + ".points", options.stages[k].points, 0, 1e6);
        check_option(stage + ".score_tolerances", options.stages[k].score_tolerances, 0.0, 1e3);
    }
    check_option(name + ".cell_diameters", options.cell_diameters, 1e-3, 10.0);
    check_option(name + ".cell_cosine", options.cell_cosine, 1e-3, 2.0);
    validate(options.inliers, name + ".inliers");
    validate(options.alignment, name + ".alignment");
    check_option(name + ".free_space_depth_diameters", options.free_space_depth_diameters, 1e-6, 10.0);
    check_option(name + ".free_space_cost", options.free_space_cost, 1.0, 100.0);
}

void validate(const PairSearchOptions& options, const std::string& name) {
    check_option(name + ".tolerance_min_distances", options.tolerance_min_distances, 0.0, 10.0);
    check_option(name + ".tolerance_sigmas", options.tolerance_sigmas, 0.0, 1e3);
    check_option(name + ".second_points", options.second_points, 1, 1000);
    check_option(name + ".max_radius_image_sides", options.max_radius_image_sides, 0.0, 10.0);
    check_option(name + ".min_sine", options.min_sine, 1e-3, 1.0);
    check_option(name + ".single_point_period", options.single_point_period, 1, 1e6);
    check_option(name + ".unbalanced_period", options.unbalanced_period, 1, 1e6);
    check_option(name + ".measured_points", options.measured_points, 1, 1e6);
    check_option(name + ".model_points", options.model_points, 0, 1e6);
}

void validate(const SearchOptions& options) {
    check_option("search.candidates", options.candidates, 0, 1e6);
    check_option("search.least_candidates", options.least_candidates, 1, 1e6);
    check_option("search.draws", options.draws, 0, 1e7);
    check_option("search.draws_factor_unsegmented", options.draws_factor_unsegmented, 1, 1e3);
    check_option("search.pair_share_segmented", options.pair_share_segmented, 0.0, 1.0);
    check_option("search.pair_share_unsegmented", options.pair_share_unsegmented, 0.0, 1.0);
    check_option("search.sphere_share", options.sphere_share, 0.0, 1.0);
    check_option("search.sphere_shifts", options.sphere_shifts, 0, 100);
    validate(options.step, "search.step");
    validate(options.surface_points, "search.surface_points");
    validate(options.closest_point_grid, "search.closest_point_grid");
    validate(options.point_pair_table, "search.point_pair_table");
    validate(options.surfels, "search.surfels");
    validate(options.pairs, "search.pairs");
    validate(options.pruning, "search.pruning");
}

}  // namespace nearpose
