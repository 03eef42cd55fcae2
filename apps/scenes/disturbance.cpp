#include "apps/scenes/disturbance.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "apps/base/simulation_draws.hpp"
#include "core/base/check.hpp"

namespace nearpose::simulate {
namespace {

constexpr int kQuietFrames = 3;  // at the beginning, for the tracker to find the part

int first_away(const Disturbances& disturbances, int num_frames) {
    return (num_frames - disturbances.look_away) / 2;
}

// Pixels of the part in some frames from `first_frame` on, in a small image.
std::vector<int> pixels_seen(const Scene& scene, const TaskPath& path, const PinholeCamera& camera, int first_frame,
                             const Pose& scene_from_object) {
    constexpr int kFrames = 6;
    const int last = static_cast<int>(path.camera_from_scene.size()) - 1;
    std::vector<int> pixels;
    for (int i = 0; i < kFrames; ++i) {
        const Pose& camera_from_scene =
            path.camera_from_scene[static_cast<std::size_t>(first_frame + (last - first_frame) * i / (kFrames - 1))];
        const RenderedFrame seen = scene.render(camera_from_scene * scene_from_object, camera_from_scene, camera);
        pixels.push_back(seen.instances.front().truth.visible_pixels);
    }
    return pixels;
}

PinholeCamera glance(const PinholeCamera& camera) {
    constexpr int kWidth = 96;
    const int stride = std::max(1, camera.width / kWidth);
    return camera_of({0, 0, stride, (camera.width + stride - 1) / stride, (camera.height + stride - 1) / stride},
                     camera);
}

Pose drawn_elsewhere(const Part& part, const Pose& scene_from_ground, std::uint64_t seed, std::uint64_t draw) {
    constexpr double kLeastTurn_rad = 20.0 * M_PI / 180.0, kMostTurn_rad = 160.0 * M_PI / 180.0;
    constexpr double kLeastShift = 0.1, kMostShift = 0.2;  // of the diameter
    RandomStream random(seed, draw, 0, kMoveDraw);
    const double turn = random.uniform(kLeastTurn_rad, kMostTurn_rad) * (random.uniform() < 0.5 ? -1.0 : 1.0);
    const double shift_m = random.uniform(kLeastShift, kMostShift) * part.extent.diameter_m();
    const double heading = random.uniform(0.0, 2.0 * M_PI);
    // The ground's origin lies below the centre of the box.
    Pose moved_in_ground;
    moved_in_ground.rotation = Eigen::AngleAxisd(turn, Eigen::Vector3d::UnitZ());
    moved_in_ground.translation = shift_m * Eigen::Vector3d(std::cos(heading), std::sin(heading), 0.0);
    return scene_from_ground * moved_in_ground * scene_from_ground.inverse();
}

}  // namespace

const std::vector<std::string>& scene_content_names() {
    static const std::vector<std::string> names = {"part", "empty", "other", "wall", "corner", "constant"};
    return names;
}

SceneContent scene_content_of(const std::string& name) {
    const auto& names = scene_content_names();
    const auto found = std::find(names.begin(), names.end(), name);
    if (found != names.end()) return static_cast<SceneContent>(found - names.begin());
    std::string known;
    for (const std::string& other : names) known += (known.empty() ? "" : ", ") + other;
    throw std::invalid_argument("'" + name + "' is no content of a scene; there are " + known);
}

void refuse_moving_parts(const char* what, Scenario scenario) {
    constexpr Scenario kStill[] = {Scenario::kBaseline, Scenario::kPiston, Scenario::kCrankcase, Scenario::kSweep,
                                   Scenario::kHandheld};
    if (std::find(std::begin(kStill), std::end(kStill), scenario) != std::end(kStill)) return;
    throw std::invalid_argument(std::string(what) + " needs a part that stands still and alone: take the scenario " +
                                "baseline, piston, crankcase, sweep or handheld, not " + name_of(scenario));
}

void validate(const Disturbances& disturbances, Scenario scenario, int num_frames, int num_delivered) {
    if (disturbances.look_away > 0) refuse_moving_parts("look_away", scenario);
    if (disturbances.object_moves) refuse_moving_parts("object_moves", scenario);
    if (disturbances.scene != SceneContent::kPart) refuse_moving_parts("a scene without the part", scenario);
    if (disturbances.scene != SceneContent::kPart && (disturbances.look_away > 0 || disturbances.object_moves))
        throw std::invalid_argument("look_away and object_moves are of a part that is there: leave out the scene");
    check_option("look_away (of the middle third of the frames)", disturbances.look_away, 0, num_frames / 3);
    if (disturbances.object_moves) check_option("frames with object_moves", num_frames, 2, 1e9);
    if (disturbances.nonsense_frames == 0) return;
    check_option("nonsense_frames (of those after the first three that show the scene)", disturbances.nonsense_frames,
                 0, std::max(0, num_delivered - kQuietFrames - disturbances.look_away));
}

bool looks_away(const Disturbances& disturbances, int frame, int num_frames) {
    const int first = first_away(disturbances, num_frames);
    return frame >= first && frame < first + disturbances.look_away;
}

std::optional<int> move_frame(const Disturbances& disturbances, int num_frames) {
    if (!disturbances.object_moves) return std::nullopt;
    if (disturbances.look_away == 0) return num_frames / 2;
    return first_away(disturbances, num_frames) + disturbances.look_away;
}

std::vector<int> nonsense_frames(const Disturbances& disturbances, const std::vector<int>& delivered, int num_frames,
                                 std::uint64_t seed) {
    std::vector<std::pair<double, int>> drawn;  // those with the least draws are taken
    for (std::size_t i = kQuietFrames; i < delivered.size(); ++i) {
        if (looks_away(disturbances, delivered[i], num_frames)) continue;
        RandomStream random(seed, static_cast<std::uint64_t>(delivered[i]), 0, kNonsenseDraw);
        drawn.emplace_back(random.uniform(), delivered[i]);
    }
    std::sort(drawn.begin(), drawn.end());
    drawn.resize(std::min(drawn.size(), static_cast<std::size_t>(disturbances.nonsense_frames)));
    std::vector<int> frames;
    for (const auto& [draw, frame] : drawn) frames.push_back(frame);
    std::sort(frames.begin(), frames.end());
    return frames;
}

DepthImage nonsense_depth(const PinholeCamera& camera, const SensorNoise& sensor, bool flat, std::uint64_t seed,
                          int frame) {
    RandomStream random(seed, static_cast<std::uint64_t>(frame), 1, kNonsenseDraw);
    const auto draw = [&] { return static_cast<float>(random.uniform(sensor.min_range_m, sensor.max_range_m)); };
    const float wall_m = draw();
    DepthImage depth{camera.width, camera.height, {}};
    depth.depth_m.assign(static_cast<std::size_t>(camera.width) * camera.height, wall_m);
    if (!flat) std::generate(depth.depth_m.begin(), depth.depth_m.end(), draw);
    return depth;
}

Pose put_down_elsewhere(const Scene& scene, const Part& part, const TaskPath& path, const PinholeCamera& camera,
                        int first_frame, std::uint64_t seed) {
    constexpr std::uint64_t kDraws = 32;
    constexpr double kEnough = 0.5;  // of the pixels of the part that stays
    const PinholeCamera small = glance(camera);
    const std::vector<int> of_still = pixels_seen(scene, path, small, first_frame, Pose::identity());
    Pose best;
    double most = -1.0;
    for (std::uint64_t draw = 0; draw < kDraws && most < kEnough; ++draw) {
        const Pose scene_from_moved = drawn_elsewhere(part, path.scene_from_ground, seed, draw);
        const std::vector<int> of_moved = pixels_seen(scene, path, small, first_frame, scene_from_moved);
        double least = 1.0;  // in the frame that sees least of it
        for (std::size_t i = 0; i < of_still.size(); ++i)
            least = std::min(least, static_cast<double>(of_moved[i]) / std::max(1, of_still[i]));
        if (least > most) best = scene_from_moved;
        most = std::max(most, least);
    }
    return best;
}

}  // namespace nearpose::simulate
