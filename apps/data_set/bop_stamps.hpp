// The time stamps of a scene's frames: what the file says where it makes sense, else what lies between.
#pragma once

#include <vector>

#include "apps/base/notices.hpp"
#include "apps/data_set/bop_scene.hpp"

namespace nearpose::data_set {

// Sets stamp_s of all frames, strictly growing. `entries` are those of scene_camera.json, parallel to `frames`. Without
// any "timestamp" a stamp is frame number / frames per second, and false is returned. Of given stamps the largest set
// that grows is kept; a frame whose stamp is missing, repeated or goes backwards gets one between its neighbours'.
// That, and gaps of more than five times the usual interval, are noted.
bool set_stamps(std::vector<Frame>& frames, const std::vector<JsonValue>& entries, double frames_per_second,
                Notices& notices);

}  // namespace nearpose::data_set
