// The measured depth of a frame with the model's outline at its estimated pose.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "core/base/pose.hpp"
#include "core/observation/observation.hpp"
#include "raycast/embree_scene.hpp"

namespace nearpose::pictures {

struct OverlayText {
    std::string caption;     // one line below the picture
    bool estimated = false;  // the pose comes from this frame; else it is predicted and drawn in another colour
};

// Near is bright and far is dark; what the mask says is not the object is grey; hatched pixels have no measurement.
// Throws std::runtime_error naming the file.
void write_overlay(const std::filesystem::path& path, const Observation& observation, const EmbreeScene& model,
                   const std::optional<Pose>& camera_from_object, const OverlayText& text);

}  // namespace nearpose::pictures
