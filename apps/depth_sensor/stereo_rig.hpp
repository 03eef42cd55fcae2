// A stereo camera with a dot projector, or a structured-light camera: what it is made of. Depth is given in the left
// infrared camera, which is the recording's camera; the right one and the projector stand along its x axis, with the
// same axes and intrinsics. A structured-light camera has no right one: it matches its image with the known pattern,
// as a camera at the projector would see it whatever the scene.
#pragma once

#include <optional>
#include <string>
#include <vector>

namespace nearpose::simulate {

// How a surface throws light back: Lambert's law, and a highlight about the half vector (Blinn 1977).
struct Material {
    double albedo = 0.5;      // share of the light that is scattered, in 0..1
    double highlight = 0.1;   // strength of the highlight, of the scattered light of a white surface
    double sharpness = 10.0;  // exponent of the highlight: the larger, the smoother the surface
};

// cast_iron, machined_aluminium, plastic.
const std::vector<std::string>& material_names();
// Throws std::invalid_argument that lists the names.
Material material_of(const std::string& name);

// Angles from the projector's axis are given as tangents: a width of 2.2 is 2.2 m at a distance of 1 m.
struct StereoRig {
    double baseline_m = 0.05;       // the right infrared camera is so far to the right of the left one
    double projector_m = 0.03;      // so far to the right stands the projector
    bool structured_light = false;  // the pattern takes the right image's place; then projector_m is baseline_m
    // The projector's dots: so many, in random places of a lattice over its field of view.
    int dots = 20000;
    double dot_sigma_tan = 0.0022;  // of a dot's Gaussian profile
    double projector_width_tan = 2.2;
    double projector_height_tan = 1.6;
    double ambient = 0.15;             // even light, as a share of the projector's at 1 m
    double infrared_sigma_grey = 4.0;  // noise of a pixel [grey levels of 255]
    double blur_pixels = 0.6;          // of the lenses, standard deviation
    int rays_per_pixel = 1;            // along each side of a pixel
    // The matcher: semi-global matching (Hirschmueller 2008) over square windows, steps of 1/16 pixel.
    int window_pixels = 9;
    int penalty_step = 2;          // for a disparity that differs by 1 from its neighbour's, times the window's area
    int penalty_jump = 8;          // for one that differs by more, likewise
    int uniqueness_percent = 8;    // by which the best match must be better than the next
    int left_right_pixels = 1;     // by which the matches of both images may differ
    int speckle_pixels = 60;       // smaller islands of depth are left out
    int speckle_range_pixels = 2;  // within which the disparities of neighbours belong to one island
    double min_range_m = 0.175;    // nearer and farther surfaces have no depth
    double max_range_m = 4.0;
};

// The section of a sensor file that describes it: active_stereo or structured_light.
std::string section_of(const StereoRig& rig);

// Throws std::invalid_argument naming field, value and bound.
void validate(const StereoRig& rig);

// The infrared noise times `scale`; scale 0 is no stereo camera, but exact depth.
std::optional<StereoRig> scaled(std::optional<StereoRig> rig, double scale);

}  // namespace nearpose::simulate
