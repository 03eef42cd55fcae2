#include "tests/core/estimator_scene.hpp"

#include <algorithm>
#include <optional>
#include <utility>

namespace nearpose::test {

Pose truth_at(int frame) {
    Twist turn = Twist::Zero();
    turn.head<3>() << 0.01 * frame, 0.0, 0.02 * frame;
    const Pose first{Eigen::Quaterniond(Eigen::AngleAxisd(2.7, Eigen::Vector3d(1, 0.3, 0.1).normalized())),
                     {0.02, 0, 0.5}};
    Pose pose = first * exp(turn);
    pose.translation.z() -= 0.02 * frame;
    return pose;
}

Pose motion_to(int frame) {
    return truth_at(frame) * truth_at(frame - 1).inverse();
}

Observation observe_at(int frame) {
    Mask mask;
    const DepthImage image = render(*kPart, truth_at(frame), kCamera, 0.9F, &mask);
    return make_observation(image, kCamera, mask);
}

Observation observe_without_mask(int frame) {
    return make_observation(render(*kPart, truth_at(frame), kCamera, 0.9F, nullptr), kCamera, std::nullopt);
}

Observation observe_nothing() {
    return make_observation({kCamera.width, kCamera.height, std::vector<float>(160 * 120, 0.0F)}, kCamera, {});
}

EstimatorOptions small_options(Method method, int threads) {
    EstimatorOptions options;
    options.method = std::move(method);
    options.method.search.candidates = std::min(options.method.search.candidates, 300);
    options.num_particles = 40;
    options.num_threads = threads;
    options.tolerance = {0.01, 0.1};  // 160 x 120 pixels of a small part: its depth is known to the sensor's scale
    return options;
}

double error_m(const UpdateResult& result, int frame) {
    const Eigen::Vector3d centre = kPart->extent().centre_in_object();
    return (result.camera_from_object * centre - truth_at(frame) * centre).norm();
}

}  // namespace nearpose::test
