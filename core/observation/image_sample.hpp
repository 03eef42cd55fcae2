// Few depths of an image, to tell whether the next one is another. A sensor's noise is drawn anew in every image, so
// that two images of one scene are never equal.
#pragma once

#include <optional>
#include <vector>

#include "core/base/pose.hpp"
#include "core/observation/observation.hpp"

namespace nearpose {

struct RepeatedImageOptions {
    bool on = true;
    int columns = 80, rows = 60;  // of the sample
    int min_measured = 100;       // depths of the sample; fewer do not tell
    double rest_pixels = 0.25;    // a camera that moves the image by less stands still
    double equal_share = 0.995;   // of the measured depths of two samples, in 0..1: the same image
};

// Throws std::invalid_argument naming field, value and bound.
void validate(const RepeatedImageOptions& options);

struct ImageSample {
    int width = 0, height = 0;   // of the image [pixels]
    std::vector<float> depth_m;  // on an even grid; 0 where nothing was measured
};

ImageSample sample_of(const Observation& observation, const RepeatedImageOptions& options);

// Whether both are of one image. Too few depths, or images of two sizes, are not.
bool same_image(const ImageSample& a, const ImageSample& b, const RepeatedImageOptions& options);

// Of the last image that was new.
struct ImageMemory {
    ImageSample sample;
    int repeats = 0;       // frames in a row that show it again
    Pose now_from_sample;  // the camera's measured motion since it was taken
};

// `now_from_before`: the camera's measured motion. A camera that stands still may see the same again where depth has no
// noise: that is no repeated image.
ImageMemory seen_again(const ImageMemory& before, const Observation& observation,
                       const std::optional<Pose>& now_from_before, const RepeatedImageOptions& options);

}  // namespace nearpose
