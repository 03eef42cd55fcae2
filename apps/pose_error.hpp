// How far an estimated pose is from the true one, for parts with symmetries.
#pragma once

#include <optional>
#include <vector>

#include "apps/data_set/bop_models.hpp"
#include "core/pose.hpp"

namespace nearpose::program {

struct PoseError {
    double translation_m = 0.0;  // of the centre of the model's box
    double rotation_rad = 0.0;
};

// A symmetric part looks the same in several poses: of them the one counts in which the corners of the model's box are
// nearest to where the estimate has them (their largest distance is least). Continuous symmetries are searched to the
// bottom, not only at samples.
PoseError pose_error(const Pose& estimated_camera_from_object, const Pose& true_camera_from_object,
                     const data_set::ModelInfo& model);

// One frame of a scene; without an error where no pose was estimated.
struct FrameError {
    int frame_id = 0;
    std::optional<PoseError> error;
};

struct ErrorStatistics {
    double mean = 0.0, median = 0.0, percentile_95 = 0.0, max = 0.0;
};

// Of at least one value. Percentiles interpolate between the values of neighbouring ranks.
ErrorStatistics statistics_of(std::vector<double> values);

struct ErrorLimit {
    double translation_m = 0.010;
    double rotation_rad = 0.0872664625997164788;  // 5 degrees
};

// The first frame from which on every frame is within the limit; nullopt where the last one is not. A frame without a
// pose is not within it.
std::optional<int> holds_from(const std::vector<FrameError>& frames, const ErrorLimit& limit);
// The first frame within the limit.
std::optional<int> arrives_at(const std::vector<FrameError>& frames, const ErrorLimit& limit);

}  // namespace nearpose::program
