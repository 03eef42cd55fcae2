#include "apps/estimator_setup.hpp"

#include <stdexcept>

#include "optim/ceres_pose_solver.hpp"
#include "raycast/embree_view_generator.hpp"
#include "raycast/raster_view_generator.hpp"
#include "raycast/sphere_view_generator.hpp"

namespace nearpose::program {

const std::vector<std::string>& view_names() {
    static const std::vector<std::string> names = {"raycast", "raster", "sphere"};
    return names;
}

const std::vector<std::string>& method_names() {
    static const std::vector<std::string> names = {"default", "paper"};
    return names;
}

std::shared_ptr<const ViewGenerator> make_view_generator(const std::string& views, const Mesh& mesh) {
    if (views == "raycast") return std::make_shared<EmbreeViewGenerator>(mesh);
    if (views == "raster") return std::make_shared<RasterViewGenerator>(mesh);
    if (views == "sphere") return std::make_shared<SphereViewGenerator>(mesh);
    throw std::invalid_argument("views '" + views + "': take raycast, raster or sphere");
}

Method make_method(const std::string& method) {
    if (method == "default") return method_default();
    if (method == "paper") return method_paper();
    throw std::invalid_argument("method '" + method + "': take default or paper");
}

std::shared_ptr<const PoseSolver> make_solver(const std::string& method) {
    CeresSolverOptions options;
    if (method == "paper") {
        options.residual = ResidualKind::kPointToPoint;
        options.loss = RobustLoss::kNone;
        options.min_pairs = 3;
    }
    return std::make_shared<CeresPoseSolver>(options);
}

}  // namespace nearpose::program
