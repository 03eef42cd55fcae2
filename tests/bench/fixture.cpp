#include "tests/bench/fixture.hpp"

#include <algorithm>
#include <cmath>

#include "apps/scenes/parts.hpp"
#include "apps/scenes/recording.hpp"
#include "core/filter/particles.hpp"
#include "core/method.hpp"
#include "core/search/sampling.hpp"

namespace nearpose::bench {
namespace {

PinholeCamera scaled(const PinholeCamera& camera, double scale) {
    const auto pixels = [&](int count) { return static_cast<int>(std::lround(count * scale)); };
    return {pixels(camera.width), pixels(camera.height),           camera.fx * scale,
            camera.fy * scale,    (camera.cx + 0.5) * scale - 0.5, (camera.cy + 0.5) * scale - 0.5};
}

}  // namespace

Pose Approach::now_from_before(int k) const {
    const auto now = static_cast<std::size_t>(k);
    return frames[now].camera_from_world * frames[now - 1].camera_from_world.inverse();
}

const Mesh& engine_block() {
    static const Mesh mesh = simulate::embedded_part("engine_block").mesh;
    return mesh;
}

Approach make_approach(const Mesh& mesh, int num_frames, double image_scale) {
    simulate::RecordingOptions options;
    options.scenario = simulate::Scenario::kPiston;
    options.num_frames = num_frames;
    options.camera = scaled(options.camera, image_scale);
    const simulate::Recording recording(mesh, simulate::engine_block_part(extent_of(mesh)), options);
    Approach approach;
    approach.camera = options.camera;
    for (int k = 0; k < recording.num_frames(); ++k) {
        simulate::SimulatedFrame frame = recording.frame(k);
        approach.frames.push_back(
            {std::move(frame.depth), std::move(frame.given_mask), frame.camera_from_object, frame.camera_from_world});
    }
    return approach;
}

const Approach& engine_block_approach() {
    static const Approach approach = make_approach(engine_block(), kApproachFrames);
    return approach;
}

PixelGrid grid_of(const Observation& observation, int max_rays) {
    constexpr double kMargin = 0.2;  // as the estimator's
    const PinholeCamera& camera = observation.camera();
    PixelBox box = observation.candidate_box();
    const int margin_u = static_cast<int>(kMargin * (box.last_u - box.first_u));
    const int margin_v = static_cast<int>(kMargin * (box.last_v - box.first_v));
    box = {std::max(0, box.first_u - margin_u), std::max(0, box.first_v - margin_v),
           std::min(camera.width, box.last_u + margin_u), std::min(camera.height, box.last_v + margin_v)};
    return grid_over(box, max_rays);
}

std::vector<Pose> particles_around(const Pose& camera_from_object, const ModelExtent& extent, int count) {
    const Method method = method_default();
    const Diffusion spread{method.filter.diffusion_rotation_rad,
                           method.filter.diffusion_diameters * extent.diameter_m()};
    return sample_around(camera_from_object, spread, extent, count, 1, 1).poses;
}

const Still& still() {
    static const Still scene = [] {
        const Approach& approach = engine_block_approach();
        const Frame& frame = approach.frames[kApproachFrames / 2];
        EmbreeViewGenerator views(engine_block());
        std::vector<Pose> particles = particles_around(frame.camera_from_object, views.extent(), 200);
        return Still{frame,
                     approach.camera,
                     make_observation(frame.depth, approach.camera, frame.mask),
                     std::move(views),
                     CeresPoseSolver{},
                     std::move(particles)};
    }();
    return scene;
}

}  // namespace nearpose::bench
