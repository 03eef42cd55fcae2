#include "tests/apps/evaluate/some_results.hpp"

namespace nearpose::program_tests {
namespace {

// Accepts frame 0, goes on at frame 2, gives up frame 3; frame 1 has no pose.
Verdict verdict_of_frame(int frame) {
    return frame == 0 ? Verdict::kAccept : frame == 2 ? Verdict::kContinue : Verdict::kLost;
}

}  // namespace

std::string evaluate(const TinyScene& scene) {
    return "evaluate --scene " + scene.scene().string() + " --models " + scene.models().string() +
           " --object 1 --burn-in 0 --results " + scene.file("poses.csv").string() + " ";
}

Pose moved(Pose pose, double offset_m) {
    pose.translation.x() += offset_m;
    return pose;
}

std::vector<data_set::PoseRow> some_rows(const TinyScene& scene, double offset_m, int scene_id) {
    std::vector<data_set::PoseRow> rows;
    for (const int frame : {0, 2, 3}) {
        rows.push_back(
            {scene_id, frame, 1, 0.9, moved(scene.truth()[static_cast<std::size_t>(frame)], offset_m), 0.01});
    }
    return rows;
}

void write_results(const TinyScene& scene, const std::vector<data_set::PoseRow>& rows) {
    data_set::PoseCsvWriter writer(scene.file("poses.csv"));
    for (const data_set::PoseRow& row : rows) writer.append(row);
    writer.close();
}

void write_log(const TinyScene& scene, const std::vector<data_set::PoseRow>& rows, const std::string& first_line) {
    std::string log = first_line + "\n";
    for (const data_set::PoseRow& row : rows) {
        UpdateResult result;
        result.status = row.image_id == 2 ? UpdateStatus::kPredicted : UpdateStatus::kEstimated;
        result.camera_from_object = row.camera_from_object;
        result.verdict = verdict_of_frame(row.image_id);
        result.covariance.diagonal() << 1e-4, 1e-4, 1e-4, 1e-6, 1e-6, 1e-6;
        log += program::frame_log_line({row.image_id, 0.0, 0.01, "", {}}, result) + "\n";
    }
    UpdateResult nothing;
    nothing.verdict = verdict_of_frame(1);
    log += program::frame_log_line({1, 0.0, 0.01, "", {}}, nothing) + "\n";
    write_text(scene.file("log.jsonl"), log);
}

}  // namespace nearpose::program_tests
