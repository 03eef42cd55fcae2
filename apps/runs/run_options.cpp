#include "apps/runs/run_options.hpp"

namespace nearpose::program {

std::unique_ptr<FrameSource> open_source(const EstimateOptions& options) {
    const data_set::SceneOptions scene{options.scene_id, options.fps, options.first, options.last};
    if (options.scene.empty()) return open_cloud_source(options.clouds, options.camera, scene, !options.no_mask);
    return open_bop_source(options.scene, scene,
                           {!options.no_mask, options.model.object, options.mask_index, options.mask_first_frame});
}

}  // namespace nearpose::program
