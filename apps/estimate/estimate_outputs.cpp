#include "apps/estimate/estimate_outputs.hpp"

#include <array>

#include "apps/base/command.hpp"
#include "apps/base/file_io.hpp"
#include "apps/base/number_text.hpp"
#include "apps/pictures/overlay.hpp"
#include "apps/runs/run_folder.hpp"

namespace nearpose::program {

OutputOptions with_run_folder(OutputOptions options) {
    if (options.run.empty()) return options;
    if (options.out.empty()) options.out = options.run / kPosesFile;
    if (options.log.empty()) options.log = options.run / kLogFile;
    if (options.trajectory.empty()) options.trajectory = options.run / kTrajectoryFile;
    return options;
}

void check(const OutputOptions& given) {
    if (given.out.empty() && given.run.empty()) {
        throw BadUse("an output is needed: --run DIR for all of it, or --out FILE for the poses");
    }
    const OutputOptions options = with_run_folder(given);
    const std::array<const std::filesystem::path*, 3> files = {&options.out, &options.log, &options.trajectory};
    for (std::size_t i = 0; i < files.size(); ++i) {
        for (std::size_t j = i + 1; j < files.size(); ++j) {
            if (!files[i]->empty() && *files[i] == *files[j] && *files[i] != "/dev/null") {
                throw BadUse("two of --out, --log and --trajectory are " + files[i]->string());
            }
        }
    }
}

EstimateOutputs::EstimateOutputs(const OutputOptions& options, const RunDescription& run, const Mesh& mesh)
    : options_(options), scene_id_(run.scene_id), object_id_(run.object_id), csv_(data_set::with_folder(options.out)) {
    if (!options.log.empty()) {
        log_.emplace(data_set::with_folder(options.log));
        log_->append(first_log_line(run));
    }
    if (!options.run.empty()) {
        particles_.emplace(data_set::with_folder(options.run / kParticlesFile));
        particles_->append(first_particles_line());
    }
    if (!options.trajectory.empty()) trajectory_.emplace(data_set::with_folder(options.trajectory));
    if (!options.pictures.empty()) {
        data_set::create_folder(options.pictures);
        scene_.emplace(mesh);
    }
}

void EstimateOutputs::append(const FrameInfo& frame, const FrameReport& report, const Observation& observation,
                             const UpdateResult& result, const ParticleSet& particles) {
    if (result.status != UpdateStatus::kNoPose) {
        csv_.append({scene_id_, frame.id, object_id_, result.score, result.camera_from_object, report.time_s});
        const auto pose = trajectory_pose(data_set::trajectory_frame_of(options_.trajectory_frame),
                                          result.camera_from_object, frame.camera_from_world);
        if (trajectory_ && pose) trajectory_->append(frame.stamp_s, *pose);
    }
    if (log_) log_->append(frame_log_line(report, result));
    if (particles_) particles_->append(particles_line(report.frame_id, particles));
    if (scene_) draw(report, observation, result);
}

void EstimateOutputs::draw(const FrameReport& report, const Observation& observation,
                           const UpdateResult& result) const {
    std::string caption = "frame " + std::to_string(report.frame_id) + "   ";
    std::optional<Pose> pose;
    if (result.status == UpdateStatus::kNoPose) {
        caption += "no pose yet";
    } else {
        pose = result.camera_from_object;
        const double distance_m = (result.camera_from_object * scene_->extent().centre_in_object()).norm();
        caption += std::string(to_string(result.status)) + "   score " + data_set::format_fixed(result.score, 2) +
                   "   distance " + data_set::format_fixed(1e3 * distance_m, 0) + " mm";
    }
    if (!report.error.empty()) caption += "   (frame could not be read)";
    const std::string name = data_set::zero_padded(report.frame_id) + ".png";
    pictures::write_overlay(options_.pictures / name, observation, *scene_, pose,
                            {caption, result.status == UpdateStatus::kEstimated});
}

void EstimateOutputs::close() {
    csv_.close();
    if (log_) log_->close();
    if (particles_) particles_->close();
    if (trajectory_) trajectory_->close();
}

}  // namespace nearpose::program
