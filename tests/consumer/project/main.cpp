// Runs the README's example, as it stands there, on frames rendered from the model.
#include <nearpose/raycast/depth_renderer.hpp>

#include "readme_example.inc"

#include <cstdio>

int main(int argc, char** argv) {
    using namespace nearpose;
    if (argc != 2) return 2;
    const Mesh mesh = load_mesh(argv[1], LengthUnit::kMillimetre).mesh;
    const EmbreeScene scene(mesh);
    const PinholeCamera camera{320, 240, 300.0, 300.0, 159.5, 119.5};
    const Pose truth{Eigen::Quaterniond(Eigen::AngleAxisd(2.5, Eigen::Vector3d(1, 0.4, 0.2).normalized())),
                     {0, 0, 0.6}};
    const std::vector<DepthImage> frames(3, render_depth(scene, truth, camera));
    const Pose pose = track(argv[1], frames, camera);
    const double error_mm = 1e3 * (pose.translation - truth.translation).norm();
    std::printf("error %.3f mm\n", error_mm);
    return error_mm < 1.0 ? 0 : 1;
}
