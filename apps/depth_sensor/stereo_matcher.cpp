// The one file that includes OpenCV; it is compiled without it where NEARPOSE_STEREO is not defined.
#include "apps/depth_sensor/stereo_matcher.hpp"

#include <algorithm>
#include <stdexcept>
#include <string>

#ifdef NEARPOSE_STEREO
#include <mutex>
#include <opencv2/calib3d.hpp>
#endif

namespace nearpose::simulate {

#ifdef NEARPOSE_STEREO

namespace {

// With so many columns in black to the left: the matcher gives no disparity to as many as it tries disparities.
cv::Mat padded(const GreyImage& image, int columns) {
    cv::Mat result(image.height, image.width + columns, CV_8UC1, cv::Scalar(0));
    for (int v = 0; v < image.height; ++v)
        std::copy_n(&image.value[static_cast<std::size_t>(v) * image.width], image.width,
                    result.ptr<std::uint8_t>(v) + columns);
    return result;
}

// The callers' threads are the only ones; the setting is the process's.
void use_one_thread() {
    static std::once_flag once;
    std::call_once(once, [] { cv::setNumThreads(1); });
}

}  // namespace

bool stereo_is_built() {
    return true;
}

void require_stereo() {}

std::vector<float> match(const GreyImage& left, const GreyImage& right, int max_disparity, const StereoRig& rig) {
    constexpr int kStep = 16;  // disparities are counted in sixteenths, and tried in multiples of so many
    constexpr int kGradientCap = 31;
    use_one_thread();
    const int count = (max_disparity / kStep + 1) * kStep, more = right.width - left.width;
    if (more < 0 || more > max_disparity || right.height != left.height)
        throw std::invalid_argument("match: the right image must have the left one's rows and columns, and at most " +
                                    std::to_string(max_disparity) + " columns more");
    const int area = rig.window_pixels * rig.window_pixels;
    const auto matcher = cv::StereoSGBM::create(
        0, count, rig.window_pixels, rig.penalty_step * area, rig.penalty_jump * area, rig.left_right_pixels,
        kGradientCap, rig.uniqueness_percent, rig.speckle_pixels, rig.speckle_range_pixels, cv::StereoSGBM::MODE_SGBM);
    cv::Mat found;
    matcher->compute(padded(left, count), padded(right, count - more), found);
    std::vector<float> disparities;
    disparities.reserve(left.value.size());
    for (int v = 0; v < left.height; ++v) {
        for (int u = 0; u < left.width; ++u) {
            const float disparity = static_cast<float>(found.at<std::int16_t>(v, u + count)) / kStep;
            disparities.push_back(disparity <= static_cast<float>(u + more) ? disparity : -1.0F);
        }
    }
    return disparities;
}

#else

bool stereo_is_built() {
    return false;
}

void require_stereo() {
    throw std::runtime_error(
        "this sensor is simulated by matching stereo images, but this nearpose was built without it: run "
        "third_party_notes/install_packages.sh stereo, then configure with -DNEARPOSE_STEREO=ON and build anew");
}

std::vector<float> match(const GreyImage&, const GreyImage&, int, const StereoRig&) {
    require_stereo();
    return {};
}

#endif

}  // namespace nearpose::simulate
