#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "apps/base/simulation_draws.hpp"
#include "apps/scenes/scenario_paths.hpp"
#include "apps/scenes/world.hpp"

namespace nearpose::simulate {
namespace {

constexpr double kMaxYaw_rad = 0.4;  // of a copy from the first; half a turn may come on top
constexpr double kGap_m = 5e-4;      // between boxes, so that no surfaces are shared

// A part's box from above.
struct Footprint {
    Eigen::Vector2d centre;  // ground frame [m]
    Eigen::Matrix2d axes;    // columns: unit vectors along its sides
    Eigen::Vector2d half;    // of its sides [m]
    double reach(const Eigen::Vector2d& direction) const { return (axes.transpose() * direction).cwiseAbs().dot(half); }
};

Footprint footprint_of(const Part& part, const Eigen::Vector2d& centre, double yaw_rad) {
    const Eigen::Vector3d half = 0.5 * (part.extent.box_max_in_object - part.extent.box_min_in_object);
    return {centre, Eigen::Rotation2Dd(yaw_rad).toRotationMatrix(), half.head<2>()};
}

// How far `moving` must go along `way` from where it is so that it has left `fixed` for good; rectangles that stand
// apart along one of their sides' normals do not overlap.
double way_past(const Footprint& moving, const Footprint& fixed, const Eigen::Vector2d& way) {
    double enter = -std::numeric_limits<double>::infinity(), leave = std::numeric_limits<double>::infinity();
    for (const Eigen::Matrix2d& axes : {moving.axes, fixed.axes}) {
        for (int side = 0; side < 2; ++side) {
            const Eigen::Vector2d normal = axes.col(side);
            const double apart = normal.dot(moving.centre - fixed.centre), speed = normal.dot(way);
            const double reach = moving.reach(normal) + fixed.reach(normal) + kGap_m;
            if (std::abs(speed) < 1e-12) {
                if (std::abs(apart) >= reach) return 0.0;
                continue;
            }
            enter = std::max(enter, std::min((-reach - apart) / speed, (reach - apart) / speed));
            leave = std::min(leave, std::max((-reach - apart) / speed, (reach - apart) / speed));
        }
    }
    return enter < leave ? std::max(0.0, leave) : 0.0;
}

void push_out(Footprint& moving, const std::vector<Footprint>& fixed, const Eigen::Vector2d& way) {
    double furthest_m = 0.0;
    for (const Footprint& other : fixed) furthest_m = std::max(furthest_m, way_past(moving, other, way));
    moving.centre += furthest_m * way;
}

}  // namespace

std::vector<Pose> pushed_together(const Part& part, std::uint64_t seed) {
    struct Cell {
        int column, row;
    };
    constexpr std::array<Cell, 8> kCells{{{1, 0}, {-1, 0}, {0, 1}, {0, -1}, {1, 1}, {-1, 1}, {1, -1}, {-1, -1}}};
    RandomStream random(seed, 1, 0, kTaskDraw);
    const Eigen::Vector3d centre = part.extent.centre_in_object();
    const double half_height = 0.5 * (part.extent.box_max_in_object - part.extent.box_min_in_object).z();
    std::vector<Footprint> placed{footprint_of(part, Eigen::Vector2d::Zero(), 0.0)};
    std::array<double, 3> column_x{0.0, 0.0, 0.0};  // of the middle row's copies; the others are pushed towards them
    std::vector<Pose> copies;
    for (const Cell& cell : kCells) {
        const double yaw = random.uniform(-kMaxYaw_rad, kMaxYaw_rad) + (random.uniform() < 0.5 ? M_PI : 0.0);
        const bool turned = random.uniform() < 0.5;
        double& x = column_x[static_cast<std::size_t>(cell.column + 1)];
        Footprint copy = footprint_of(part, {x, 0.0}, yaw);
        push_out(copy, placed, cell.row == 0 ? Eigen::Vector2d(cell.column, 0.0) : Eigen::Vector2d(0.0, cell.row));
        if (cell.row == 0) x = copy.centre.x();
        placed.push_back(copy);
        Pose pose;
        pose.rotation = Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ());
        if (turned) pose.rotation = pose.rotation * turned_from_object().rotation;
        pose.translation = Eigen::Vector3d(copy.centre.x(), copy.centre.y(), half_height) - pose.rotation * centre;
        copies.push_back(pose);
    }
    return copies;
}

}  // namespace nearpose::simulate
