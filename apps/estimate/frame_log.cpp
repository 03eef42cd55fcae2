#include "apps/estimate/frame_log.hpp"

#include <array>
#include <charconv>
#include <nlohmann/json.hpp>

#include "core/filter/particles.hpp"

namespace nearpose::program {
namespace {

using Json = nlohmann::ordered_json;

Json row_major(const Matrix6d& matrix) {
    Json numbers = Json::array();
    for (int row = 0; row < 6; ++row) {
        for (int column = 0; column < 6; ++column) numbers.push_back(matrix(row, column));
    }
    return numbers;
}

Json translation_m(const Pose& pose) {
    return {pose.translation.x(), pose.translation.y(), pose.translation.z()};
}

// x y z w with w >= 0.
Json quaternion_xyzw(const Pose& pose) {
    const Eigen::Vector4d xyzw =
        pose.rotation.w() < 0.0 ? Eigen::Vector4d(-pose.rotation.coeffs()) : Eigen::Vector4d(pose.rotation.coeffs());
    return {xyzw.x(), xyzw.y(), xyzw.z(), xyzw.w()};
}

Json counts_of(const StepCounts& counts) {
    return {{"view_points", counts.view_points},
            {"pairs", counts.pairs},
            {"rejected_by_normal", counts.rejected_by_normal},
            {"rejected_by_consensus", counts.rejected_by_consensus},
            {"solves", counts.solves},
            {"solves_with_too_few_pairs", counts.solves_with_too_few_pairs},
            {"solves_not_usable", counts.solves_not_usable}};
}

Json seconds_of(const UpdateSeconds& seconds) {
    return {{"total", seconds.total},
            {"start", seconds.start},
            {"particles", seconds.particles},
            {"refinement", seconds.refinement},
            {"views_all_threads", seconds.stages.views},
            {"association_all_threads", seconds.stages.association},
            {"solving_all_threads", seconds.stages.solving},
            {"likelihood_all_threads", seconds.stages.likelihood}};
}

// What a frame was made with.
Json effort_of(const Effort& effort) {
    return {{"starts", effort.starts},
            {"particles", effort.particles},
            {"rivals", effort.alternatives},
            {"modes", effort.modes},
            {"reduced_for_budget", effort.reduced_for_budget}};
}

Json modes_of(const std::vector<Mode>& modes) {
    Json list = Json::array();
    for (const Mode& mode : modes) {
        list.push_back({{"translation_m", translation_m(mode.camera_from_object)},
                        {"quaternion_xyzw", quaternion_xyzw(mode.camera_from_object)},
                        {"cost", mode.cost},
                        {"weight", mode.weight},
                        {"covariance", row_major(mode.covariance)}});
    }
    return list;
}

// What keeps the estimate from being accepted, in the requirement's unit and in words.
Json missing_of(const std::vector<Shortfall>& missing) {
    Json list = Json::array();
    for (const Shortfall& shortfall : missing)
        list.push_back({{"requirement", to_string(shortfall.requirement)},
                        {"value", shortfall.value},
                        {"limit", shortfall.limit},
                        {"text", describe(shortfall)}});
    return list;
}

Json evidence_of(const PositiveEvidence& evidence) {
    return {{"relief", evidence.relief},         {"steps", evidence.steps},       {"occlusion", evidence.occlusion},
            {"free_space", evidence.free_space}, {"coplanar", evidence.coplanar}, {"total", evidence.total()}};
}

// Whether the images move as the arm says, and what explains it better that the part seems to move.
Json arm_of(const ArmFindings& arm) {
    Json causes = Json::object();
    for (std::size_t k = 0; k < arm.world.evidence.size(); ++k) {
        const CauseEvidence& evidence = arm.world.evidence[k];
        causes[to_string(static_cast<Cause>(k))] = {
            {"log_odds", evidence.log_odds}, {"shift_m", evidence.shift_m}, {"sigma_m", evidence.sigma_m}};
    }
    return {{"pairs", arm.motion.pairs},
            {"off_share", arm.motion.off_share},
            {"moves", to_string(arm.motion.mistake)},
            {"sightings", arm.world.sightings},
            {"cause", to_string(arm.world.cause)},
            {"error_bound_m", arm.world.error_bound_m},
            {"causes", causes}};
}

// Of one observation, largest standard deviation first; a turn counts with the way of a point at half the diameter.
Json observability_of(const Observability& observability) {
    Json sigmas = Json::array();
    for (const double sigma_m : observability.sigmas_m) sigmas.push_back(sigma_m);
    return {{"sigmas_m", sigmas}, {"weak", observability.weak}};
}

// The keys of the pose in the camera, in the frame that the arm's poses are given in.
Json in_world_of(const PlaceInWorld& place) {
    return {{"translation_m", translation_m(place.world_from_object)},
            {"quaternion_xyzw", quaternion_xyzw(place.world_from_object)},
            {"covariance", row_major(place.covariance)},
            {"covariance_ros", row_major(ros_covariance(place.covariance, place.world_from_object))}};
}

// What the covariance in the world takes the camera's pose to be off by: standard deviations.
Json usual_setup(const ArmCheckOptions& arm) {
    const SetupSigmas& usual = arm.still_world.usual;
    return {{"hand_eye_rad", usual.hand_eye_rad},
            {"hand_eye_m", usual.hand_eye_m},
            {"time_offset_frames", usual.time_offset_frames},
            {"arm_rotation_rad", arm.sightings.arm_rotation_rad},
            {"arm_translation_m", arm.sightings.arm_translation_m}};
}

// Six significant digits: micrometres at a metre, in half the bytes of all digits.
void append_rounded(std::string& text, double value) {
    std::array<char, 32> digits{};
    const auto end = std::to_chars(digits.data(), digits.data() + digits.size(), value, std::chars_format::general, 6);
    text.append(digits.data(), end.ptr);
}

// Text from file names need not be UTF-8.
std::string dump(const Json& object) {
    return object.dump(-1, ' ', false, Json::error_handler_t::replace);
}

}  // namespace

Matrix6d ros_covariance(const Matrix6d& covariance, const Pose& frame_from_object) {
    Matrix6d map = Matrix6d::Zero();
    map.topRightCorner<3, 3>() = frame_from_object.rotation_matrix();
    map.bottomLeftCorner<3, 3>() = frame_from_object.rotation_matrix();
    return map * covariance * map.transpose();
}

std::string first_log_line(const RunDescription& run) {
    return dump(
        {{"format", 1},
         {"content", "nearpose estimate"},
         {"pose", "camera_from_object"},
         {"camera_frame", "x right, y down, z forward"},
         {"units", "m, rad, s"},
         {"quaternion_order", "x y z w"},
         {"covariance_order", "rotation x y z, translation x y z; of camera_from_object * exp(twist), object axes"},
         {"covariance_ros_order", "x y z, rotation x y z; axes of the camera frame"},
         {"world",
          "that of cam_R_w2c, cam_t_w2c; world_from_object has the keys of the pose, covariance_ros in its axes"},
         {"world_sigmas", usual_setup({})},
         {"input", run.input},
         {"model", run.model},
         {"scene_id", run.scene_id},
         {"object_id", run.object_id},
         {"views", run.views},
         {"method", run.method},
         {"particles", run.particles},
         {"adaptive", run.adaptive},
         {"budget_s", run.budget_s},
         {"seed", run.seed},
         {"tolerance_m", run.tolerance.translation_m},
         {"tolerance_rad", run.tolerance.rotation_rad}});
}

std::string first_particles_line() {
    return dump({{"format", 1},
                 {"content", "nearpose particles"},
                 {"pose", "camera_from_object"},
                 {"columns", "x y z [m], quaternion x y z w, weight (of sum 1)"}});
}

std::string particles_line(int frame_id, const ParticleSet& particles) {
    const std::vector<double> shares = posterior_probabilities(particles.negative_log_weights);
    std::string line = "{\"frame\":" + std::to_string(frame_id) + ",\"particles\":[";
    for (std::size_t i = 0; i < particles.poses.size(); ++i) {
        const Pose& pose = particles.poses[i];
        const Eigen::Vector4d xyzw = pose.rotation.w() < 0.0 ? Eigen::Vector4d(-pose.rotation.coeffs())
                                                             : Eigen::Vector4d(pose.rotation.coeffs());
        const std::array<double, 8> row = {pose.translation.x(),
                                           pose.translation.y(),
                                           pose.translation.z(),
                                           xyzw.x(),
                                           xyzw.y(),
                                           xyzw.z(),
                                           xyzw.w(),
                                           shares[i]};
        line += i == 0 ? "[" : ",[";
        for (std::size_t column = 0; column < row.size(); ++column) {
            if (column > 0) line += ',';
            append_rounded(line, row[column]);
        }
        line += ']';
    }
    return line + "]}";
}

std::string frame_log_line(const FrameReport& frame, const UpdateResult& result) {
    Json line = {{"frame", frame.frame_id},
                 {"stamp_s", frame.stamp_s},
                 {"status", to_string(result.status)},
                 {"verdict", to_string(result.verdict)},
                 {"missing", missing_of(result.missing)}};
    if (!frame.error.empty()) line["error"] = frame.error;
    if (result.status != UpdateStatus::kNoPose) {
        line["translation_m"] = translation_m(result.camera_from_object);
        line["quaternion_xyzw"] = quaternion_xyzw(result.camera_from_object);
        line["covariance"] = row_major(result.covariance);
        line["covariance_ros"] = row_major(ros_covariance(result.covariance, result.camera_from_object));
        line["score"] = result.score;
        line["agreement"] = result.pixels.agreement();
        line["log_odds_present"] = result.log_odds_present;
        line["positive_evidence"] = evidence_of(result.positive_evidence);
        line["observability"] = observability_of(result.observability);
        line["cost"] = result.cost;
        line["arm"] = arm_of(result.arm);
        if (frame.in_world) line["world_from_object"] = in_world_of(*frame.in_world);
    }
    line["effective_sample_size"] = result.effective_sample_size;
    line["effort"] = effort_of(result.effort);
    line["resampled"] = result.resampled;
    line["mode_replaced"] = result.mode_replaced;
    line["points_observed"] = result.points_observed;
    line["time_s"] = frame.time_s;
    line["counts"] = counts_of(result.counts);
    line["seconds"] = seconds_of(result.seconds);
    line["modes"] = modes_of(result.modes);
    return dump(line);
}

}  // namespace nearpose::program
