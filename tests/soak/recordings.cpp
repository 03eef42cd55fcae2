#include "tests/soak/recordings.hpp"

#include <cmath>
#include <limits>
#include <random>

#include "apps/runs/estimator_setup.hpp"
#include "apps/scenes/parts.hpp"

namespace nearpose::soak {
namespace {

constexpr int kFramesOfRecording = 24;

struct View {
    const char* scenario;
    PinholeCamera camera;
};

std::vector<Frame> record(const simulate::EmbeddedPart& part, const View& view, std::uint64_t seed) {
    simulate::RecordingOptions options;
    options.scenario = simulate::scenario_of(view.scenario);
    options.num_frames = kFramesOfRecording;
    options.camera = view.camera;
    options.seed = seed;
    const simulate::Recording recording(part.mesh, part.part, options);
    std::vector<Frame> frames;
    for (int k = 0; k < recording.num_frames(); ++k) {
        simulate::SimulatedFrame frame = recording.frame(k);
        const bool shows_part = frame.shows_part();
        frames.push_back({frame.camera, std::move(frame.depth), std::move(frame.given_mask), frame.camera_from_object,
                          frame.camera_from_world, shows_part});
    }
    return frames;
}

// Images of nothing that is the part: a wall, no depth, what is no number, noise, and depth of no scene at all.
std::vector<Frame> nonsense(const PinholeCamera& camera, std::uint64_t seed) {
    constexpr float kNaN = std::numeric_limits<float>::quiet_NaN(), kInfinite = std::numeric_limits<float>::infinity();
    const auto pixels = static_cast<std::size_t>(camera.width * camera.height);
    std::mt19937_64 random(seed);
    std::vector<Frame> frames;
    for (const float depth_m : {0.0F, 0.4F, kNaN, kInfinite, -kInfinite, -1.0F, 1e-38F, 3e38F})
        frames.push_back({camera, {camera.width, camera.height, std::vector<float>(pixels, depth_m)}, {}, {}, {}});
    const std::vector<float> odd = {0.0F, kNaN, kInfinite, -0.3F, 1e30F, 0.3F};
    for (int kind = 0; kind < 4; ++kind) {
        std::vector<float> depth_m(pixels);
        for (std::size_t i = 0; i < pixels; ++i) {
            const float noise = static_cast<float>(random() % 10000) / 1e4F;
            const auto u = static_cast<float>(i % camera.width), v = static_cast<float>(i / camera.width);
            depth_m[i] = kind == 0   ? 0.1F + noise                                         // even noise
                         : kind == 1 ? odd[random() % odd.size()]                           // of all kinds
                         : kind == 2 ? 0.3F + 0.001F * u + 0.0005F * v                      // a slope
                                     : 0.3F + 0.05F * std::sin(u / 5.0F) + 0.001F * noise;  // waves
        }
        frames.push_back({camera, {camera.width, camera.height, std::move(depth_m)}, {}, {}, {}});
    }
    return frames;
}

}  // namespace

Recordings make_recordings(std::uint64_t seed) {
    const PinholeCamera usual{320, 240, 300.0, 300.0, 159.5, 119.5}, small{160, 120, 150.0, 151.0, 80.2, 60.1},
        wide{401, 201, 260.0, 262.0, 190.0, 110.0};
    const simulate::EmbeddedPart part = simulate::embedded_part("bracket");
    Recordings recordings;
    recordings.views = program::make_view_generator({}, part.mesh);
    for (const View& view :
         {View{"baseline", usual}, View{"sweep", usual}, View{"handheld", small}, View{"sweep", wide}})
        recordings.frames.push_back(record(part, view, seed++));
    for (const PinholeCamera& camera : {usual, small, PinholeCamera{1, 1, 1.0, 1.0, 0.0, 0.0}}) {
        const std::vector<Frame> frames = nonsense(camera, seed++);
        recordings.without_part.insert(recordings.without_part.end(), frames.begin(), frames.end());
    }
    return recordings;
}

}  // namespace nearpose::soak
