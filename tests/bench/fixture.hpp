// What the benchmarks work on: simulated approaches to the engine block, in memory.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "core/base/depth_image.hpp"
#include "core/base/pose.hpp"
#include "core/filter/gradient_step.hpp"
#include "core/observation/observation.hpp"
#include "optim/ceres_pose_solver.hpp"
#include "raycast/embree_view_generator.hpp"
#include "raycast/mesh.hpp"

namespace nearpose::bench {

inline constexpr int kApproachFrames = 21;  // the first one is where the object is searched for

struct Frame {
    DepthImage depth;
    Mask mask;
    Pose camera_from_object;  // true
    Pose camera_from_world;   // as the arm reports it
};

struct Approach {
    PinholeCamera camera;
    std::vector<Frame> frames;

    // The camera's motion from frame k - 1 to frame k; k >= 1.
    Pose now_from_before(int k) const;
};

const Mesh& engine_block();  // 11,818 triangles

// The scenario `piston` (60 -> 18 cm over the part) with masks; the image is 640 x 480 pixels times `image_scale`.
Approach make_approach(const Mesh& mesh, int num_frames, double image_scale = 1.0);
const Approach& engine_block_approach();

// The grid of about `max_rays` rays that the estimator casts views on where a mask says where the object is.
PixelGrid grid_of(const Observation& observation, int max_rays);

// `count` poses spread as the default method's particles are after diffusion.
std::vector<Pose> particles_around(const Pose& camera_from_object, const ModelExtent& extent, int count);

// The middle frame of the approach, ready for the stages.
struct Still {
    const Frame& frame;
    const PinholeCamera& camera;
    Observation observation;
    EmbreeViewGenerator views;
    CeresPoseSolver solver;
    std::vector<Pose> particles;  // 200 poses
};
const Still& still();

}  // namespace nearpose::bench
