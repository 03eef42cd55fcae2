#include "apps/report/run_report.hpp"

#include <nlohmann/json.hpp>
#include <numbers>

#include "apps/data_set/png_file.hpp"
#include "apps/report/arm_figures.hpp"
#include "apps/report/cloud_sample.hpp"
#include "apps/report/depth_picture.hpp"
#include "apps/report/quantised.hpp"
#include "apps/report/run_figures.hpp"
#include "apps/report/run_input.hpp"
#include "apps/report/shown_mesh.hpp"
#include "apps/report/text_forms.hpp"
#include "apps/runs/estimator_setup.hpp"
#include "core/base/parallel.hpp"

namespace nearpose::report {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kMaxTriangles = 40000;

Json vector_json(const Eigen::Vector3d& vector) {
    return {vector.x(), vector.y(), vector.z()};
}

// x y z [m], quaternion x y z w.
Json pose_json(const std::optional<Pose>& pose) {
    if (!pose) return nullptr;
    const Eigen::Vector3d& t = pose->translation;
    const Eigen::Quaterniond& q = pose->rotation;
    return {t.x(), t.y(), t.z(), q.x(), q.y(), q.z(), q.w()};
}

Json points_json(const std::vector<Eigen::Vector3f>& points_m) {
    const QuantisedPoints points = quantise(points_m);
    return {{"offset_m", vector_json(points.offset_m)}, {"step_m", points.step_m}, {"int16", base64_of(points.values)}};
}

Json picture_json(const GreyPicture& picture) {
    const std::string png = data_set::grey_png_bytes(picture.width, picture.height, picture.grey);
    return "data:image/png;base64," + base64_of(png);
}

Json model_json(const Mesh& mesh) {
    const ModelExtent extent = extent_of(mesh);
    const Mesh shown = shown_mesh(mesh, kMaxTriangles);
    std::vector<std::uint32_t> corners;
    for (const std::array<int, 3>& triangle : shown.triangles)
        corners.insert(corners.end(), triangle.begin(), triangle.end());
    return {{"vertices", points_json(shown.vertices_in_object)},
            {"triangles_uint32", base64_of(corners)},
            {"centre_m", vector_json(extent.centre_in_object())},
            {"diameter_m", extent.diameter_m()}};
}

// What needs the frame's files. A file that cannot be read leaves the frame without a picture, as it left the run.
Json seen_json(const RunInput& input, std::size_t index, const EmbreeScene& model, const RunReportOptions& options) {
    const LoggedFrame& logged = input.log[index];
    const program::FrameInfo& info = input.source->frames()[input.frame_in_source[index]];
    program::FrameData data;
    try {
        data = input.source->load(input.frame_in_source[index]);
    } catch (const std::exception& error) {
        return {{"unread", error.what()}};
    }
    const Observation observation = observe_frame(info, data);
    // Far walls would make the part a dot.
    const double centre_m = observation.num_candidates() > 0 ? observation.mean_distance_m() : 1.0;
    const double max_depth_m = centre_m + 1.5 * model.extent().diameter_m();
    const CloudSample cloud =
        sample_cloud(observation, model, logged.camera_from_object, options.max_points, max_depth_m);
    const DepthPicture picture = depth_picture(observation, data.mask, model, logged.camera_from_object);
    const PinholeCamera& camera = info.camera;
    return {{"cloud", points_json(cloud.points_in_camera)},
            {"on_part", cloud.on_part},
            {"residuals_int16", base64_of(cloud.residuals)},
            {"residual_unit_mm", 1e3 * kResidualUnitM},
            {"near_m", picture.near_m},
            {"far_m", picture.far_m},
            {"depth_png", picture_json(picture.depth)},
            {"lines_png", picture_json(picture.lines)},
            {"has_mask", data.mask.has_value()},
            {"camera", {camera.width, camera.height, camera.fx, camera.fy, camera.cx, camera.cy}}};
}

Json missing_json(const std::vector<LoggedLack>& missing) {
    Json list = Json::array();
    for (const LoggedLack& lack : missing) list.push_back({{"requirement", lack.requirement}, {"text", lack.text}});
    return list;
}

Json frame_json(const RunInput& input, std::size_t index, const evaluation::FrameErrors& errors,
                const EmbreeScene& model, const RunReportOptions& options) {
    const LoggedFrame& logged = input.log[index];
    const auto truth = input.truth.find(logged.frame_id);
    Json frame = {{"id", logged.frame_id},
                  {"stamp_s", logged.stamp_s},
                  {"status", logged.status},
                  {"pose", pose_json(logged.camera_from_object)},
                  {"truth", truth == input.truth.end() ? Json(nullptr) : pose_json(truth->second)},
                  {"effective_sample_size", logged.effective_sample_size},
                  {"points_observed", logged.points_observed},
                  {"mode_replaced", logged.mode_replaced}};
    if (!logged.error.empty()) frame["error"] = logged.error;
    if (logged.verdict) {
        frame["verdict"] = to_string(*logged.verdict);
        frame["missing"] = missing_json(logged.missing);
    }
    if (logged.time_s >= 0.0) frame["time_ms"] = 1e3 * logged.time_s;
    if (logged.agreement) frame["agreement"] = *logged.agreement;
    if (logged.score) frame["score"] = *logged.score;
    if (logged.covariance && logged.status == "estimated") {
        const Sigma sigma = sigma_of(*logged.covariance, model.extent().centre_in_object());
        frame["sigma_mm"] = sigma.translation_mm;
        frame["sigma_deg"] = sigma.rotation_deg;
    }
    if (errors.errors) {
        frame["error_mm"] = 1e3 * errors.errors->translation_m;
        frame["error_deg"] = 180.0 / std::numbers::pi * errors.errors->rotation_rad;
    }
    if (const auto rows = input.particles.find(logged.frame_id); rows != input.particles.end()) {
        frame["particles_float32"] = base64_of(rows->second);
    }
    frame.update(seen_json(input, index, model, options));
    return frame;
}

Json run_json(const program::RunRecord& record, const RunInput& input) {
    const program::EstimateOptions& options = record.options;
    Json program = Json::object();
    for (const auto& [name, value] : record.program) program[name] = value;
    return {{"input", (options.scene.empty() ? options.clouds : options.scene).string()},
            {"model", model_file(options.model).string()},
            {"object", options.model.object},
            {"scene_id", record.scene_id},
            {"method", options.method},
            {"views", options.views},
            {"particles", options.particles.value_or(program::EstimatorSetup{}.particles)},
            {"seed", options.seed},
            {"mask", !options.no_mask && input.source->has_masks()},
            {"motion", !options.no_control},
            {"initial_pose", options.initial_pose.string()},
            {"program", program}};
}

}  // namespace

Report run_report(const std::filesystem::path& folder, const RunReportOptions& options,
                  const std::function<void(const std::string&)>& notice) {
    const RunInput input = read_run(folder, options, notice);
    const EmbreeScene model(input.mesh);
    const std::vector<evaluation::FrameErrors> errors = errors_of_run(input);
    std::vector<Json> frames(input.log.size());
    parallel_for(static_cast<int>(frames.size()), options.threads,
                 [&](int i) { frames[i] = frame_json(input, i, errors[i], model, options); });
    const std::string title = "Object " + std::to_string(input.record.options.model.object) + " in scene " +
                              std::to_string(input.record.scene_id);
    const Json data = {{"format", 1},
                       {"kind", "run"},
                       {"title", title},
                       {"run", run_json(input.record, input)},
                       {"figures", figures_json(input, errors, options.burn_in)},
                       {"arm", arm_json(input.log, model.extent().centre_in_object())},
                       {"model", model_json(input.mesh)},
                       {"frames", frames}};
    return {title + " - nearpose", data.dump(-1, ' ', false, Json::error_handler_t::replace)};
}

}  // namespace nearpose::report
