#include "apps/data_set/bop_pose.hpp"

#include <stdexcept>
#include <vector>

#include "apps/base/number_text.hpp"

namespace nearpose::data_set {
namespace {

// Files round rotations to a few digits; beyond this a matrix is a mistake, not a rounding.
constexpr double kRounding = 1e-3;
// A frame without its motion costs more than a motion that is half a degree off.
constexpr double kMotionRounding = 1e-2;

struct NearestPose {
    Pose pose;
    double off = 0.0;  // the largest difference of an element of the rotation
};

NearestPose read_nearest(const JsonValue& frame, const std::string& rotation_key, const std::string& translation_key,
                         double tolerance) {
    const JsonValue rotation = frame.at(rotation_key);
    const std::vector<double> r = rotation.numbers(9);
    const std::vector<double> t = frame.at(translation_key).numbers(3);
    Eigen::Matrix3d matrix;
    matrix << r[0], r[1], r[2], r[3], r[4], r[5], r[6], r[7], r[8];
    const Pose nearest = Pose::from_matrix(matrix, Eigen::Vector3d(t[0], t[1], t[2]) * 1e-3);
    const double off = (matrix - nearest.rotation_matrix()).cwiseAbs().maxCoeff();
    if (matrix.determinant() < 0.0) throw rotation.error("is a reflection, not a rotation");
    if (!(off <= tolerance)) throw rotation.error("is not a rotation: it is off the nearest by " + format_number(off));
    return {nearest, off};
}

}  // namespace

Pose read_bop_pose(const JsonValue& frame, const std::string& rotation_key, const std::string& translation_key) {
    return read_nearest(frame, rotation_key, translation_key, kRounding).pose;
}

std::optional<Pose> read_motion(const JsonValue& frame, int frame_id, Notices& notices) {
    const std::string rotation = "cam_R_w2c", translation = "cam_t_w2c";
    if (!frame.find(rotation) && !frame.find(translation)) return std::nullopt;
    try {
        const NearestPose motion = read_nearest(frame, rotation, translation, kMotionRounding);
        if (motion.off > kRounding) {
            const std::string off = "is off a rotation by " + format_fixed(motion.off, 4);
            notices.add(frame_id, frame.at(rotation).error(off + "; the nearest rotation is taken").what());
        }
        return motion.pose;
    } catch (const std::runtime_error& error) {
        notices.add(frame_id, std::string(error.what()) + "; the frame is taken without the camera's motion");
        return std::nullopt;
    }
}

}  // namespace nearpose::data_set
