#include "apps/simulate/simulate.hpp"

#include <algorithm>
#include <atomic>
#include <map>
#include <mutex>

#include "apps/base/file_io.hpp"
#include "apps/base/number_text.hpp"
#include "apps/data_set/bop_models.hpp"
#include "apps/data_set/bop_scene.hpp"
#include "apps/data_set/bop_writer.hpp"
#include "apps/data_set/model_diameter.hpp"
#include "apps/data_set/png_file.hpp"
#include "apps/data_set/trajectory_tum.hpp"
#include "apps/part_model/model_symmetries.hpp"
#include "apps/scenes/parts.hpp"
#include "apps/simulate/staged_folder.hpp"
#include "core/base/parallel.hpp"
#include "raycast/mesh_loader.hpp"

namespace nearpose::simulate {
namespace {

namespace fs = std::filesystem;

constexpr int kSceneId = 1;
constexpr int kUnnamedId = 1;  // of a part that is not built in
// Share of the silhouette that must be seen for another instance to be asked for, as BOP's own lists have it.
constexpr double kLeastVisibleFraction = 0.1;

void write_grey(const fs::path& path, const GreyImage& image) {
    data_set::write_file_atomically(path, data_set::grey_png_bytes(image.width, image.height, image.value));
}

// Simulates one frame and writes its images.
data_set::FrameRecord write_frame(const Recording& recording, int index, const fs::path& folder) {
    const SimulatedFrame frame = recording.frame(index);
    data_set::FrameRecord record;
    record.id = frame.id;
    record.camera = frame.camera;
    record.depth_scale_mm = recording.options().depth_scale_mm;
    record.camera_from_world = frame.camera_from_world;
    record.timestamp_s = frame.stamp_s;
    data_set::write_depth_png(data_set::depth_path(folder, frame.id), frame.depth, record.depth_scale_mm);
    if (frame.infrared) {
        write_grey(folder / "infrared_left" / (data_set::zero_padded(frame.id) + ".png"), frame.infrared->left);
        write_grey(folder / "infrared_right" / (data_set::zero_padded(frame.id) + ".png"), frame.infrared->right);
    }
    const auto add_object = [&](const data_set::ObjectTruth& truth, const Mask& visible, const Mask& silhouette) {
        const int instance = static_cast<int>(record.objects.size());
        data_set::write_mask_png(data_set::mask_path(folder, frame.id, instance, true), visible);
        data_set::write_mask_png(data_set::mask_path(folder, frame.id, instance, false), silhouette);
        record.objects.push_back(truth);
    };
    add_object(frame.truth, frame.given_mask, frame.silhouette);
    for (const OtherInstance& other : frame.others) add_object(other.truth, other.visible, other.silhouette);
    return record;
}

// The symmetries by object number; none are looked for unless `find`.
std::map<int, Symmetries> write_models(const std::map<int, Mesh>& models, bool find, const fs::path& data_set_folder) {
    std::map<int, data_set::ModelInfo> infos;
    std::map<int, Symmetries> symmetries;
    for (const auto& [id, mesh] : models) {
        const ModelExtent extent = extent_of(mesh);
        data_set::ModelInfo& info = infos[id];
        info.diameter_m = data_set::diameter_of(mesh.vertices_in_object);
        info.box_min_in_object_m = extent.box_min_in_object;
        info.box_max_in_object_m = extent.box_max_in_object;
        if (find) symmetries[id] = program::find_symmetries(mesh);
        program::declare(symmetries[id], info);
    }
    for (const char* name : {"models", "models_eval"}) {
        const fs::path folder = data_set_folder / name;
        data_set::create_folder(folder);
        for (const auto& [id, mesh] : models) {
            save_ply(mesh, folder / ("obj_" + data_set::zero_padded(id) + ".ply"), LengthUnit::kMillimetre);
        }
        data_set::write_models_info(folder / "models_info.json", infos);
    }
    return symmetries;
}

// A set of built-in parts has all of them, so that it can be taken for a set of three objects.
std::map<int, Mesh> models_of(const Mesh& mesh, const std::string& part_name) {
    if (part_name.empty()) return {{kUnnamedId, mesh}};
    std::map<int, Mesh> models;
    for (const std::string& name : part_names()) models[object_id_of(name)] = embedded_part(name).mesh;
    models[object_id_of(part_name)] = mesh;
    return models;
}

// How often each object is to be found in the image.
std::map<int, int> targets_in(const data_set::FrameRecord& record) {
    std::map<int, int> instances;
    for (std::size_t i = 0; i < record.objects.size(); ++i) {
        const data_set::ObjectTruth& object = record.objects[i];
        const double least = i == 0 ? 0.0 : kLeastVisibleFraction * object.silhouette_pixels;
        if (object.visible_pixels > 0 && object.visible_pixels >= least) ++instances[object.object_id];
    }
    return instances;
}

void write_lists(const std::vector<data_set::FrameRecord>& records, const fs::path& folder) {
    std::vector<data_set::TestTarget> targets;
    data_set::TumWriter truth(folder / "truth.tum");
    for (const data_set::FrameRecord& record : records) {
        truth.append(*record.timestamp_s, record.objects.front().camera_from_object);
        for (const auto& [object_id, count] : targets_in(record)) {
            targets.push_back({kSceneId, record.id, object_id, count});
        }
    }
    truth.close();
    data_set::write_test_targets(folder / "test_targets_bop19.json", targets);
}

// False where `frame_done` asked to stop.
bool write_frames(const Recording& recording, const fs::path& scene_folder, int num_threads,
                  const std::function<bool()>& frame_done, std::vector<data_set::FrameRecord>& records) {
    for (const char* name : {"depth", "mask", "mask_visib"}) data_set::create_folder(scene_folder / name);
    if (recording.options().keep_infrared)
        for (const char* name : {"infrared_left", "infrared_right"}) data_set::create_folder(scene_folder / name);
    records.resize(static_cast<std::size_t>(recording.num_frames()));
    std::atomic<bool> stopped = false;
    std::mutex mutex;
    parallel_for(recording.num_frames(), num_threads, [&](int index) {
        if (stopped) return;
        records[static_cast<std::size_t>(index)] = write_frame(recording, index, scene_folder);
        const std::lock_guard lock(mutex);
        if (!frame_done()) stopped = true;
    });
    return !stopped;
}

}  // namespace

SimulationSummary write_data_set(const Mesh& mesh, const Part& part, const SimulationOptions& options,
                                 const std::function<bool()>& frame_done) {
    const Recording recording(mesh, part, options.recording);
    StagedFolder staged(options.data_set, options.replace,
                        {"camera.json", "models", "models_eval", "test", "test_targets_bop19.json", "truth.tum"});
    const fs::path scene_folder = staged.path() / "test" / "000001";
    SimulationSummary summary;
    std::vector<data_set::FrameRecord> records;
    const int num_threads = remembers_images(options.recording.faults) ? 1 : options.num_threads;  // in their order
    if (!write_frames(recording, scene_folder, num_threads, frame_done, records)) return summary;

    data_set::BopSceneWriter writer(scene_folder);
    for (const data_set::FrameRecord& record : records) {
        writer.add_frame(record);
        if (record.objects.front().measured_pixels == 0) ++summary.frames_without_part;
    }
    writer.finish();
    const std::string& name = options.recording.part_name;
    const auto symmetries = write_models(models_of(mesh, name), options.find_symmetries, staged.path());
    summary.symmetries = symmetries.at(name.empty() ? kUnnamedId : object_id_of(name));
    write_lists(records, staged.path());
    staged.commit();
    summary.complete = true;
    return summary;
}

}  // namespace nearpose::simulate
