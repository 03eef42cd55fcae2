#include "apps/simulate/simulate.hpp"

#include <algorithm>
#include <atomic>
#include <map>
#include <mutex>

#include "apps/data_set/bop_models.hpp"
#include "apps/data_set/bop_scene.hpp"
#include "apps/data_set/bop_writer.hpp"
#include "apps/data_set/file_io.hpp"
#include "apps/data_set/png_file.hpp"
#include "apps/data_set/trajectory_tum.hpp"
#include "apps/import/import_model.hpp"
#include "apps/simulate/scene.hpp"
#include "apps/simulate/staged_folder.hpp"
#include "core/check.hpp"
#include "core/parallel.hpp"
#include "raycast/mesh_loader.hpp"

namespace nearpose::simulate {
namespace {

namespace fs = std::filesystem;

constexpr int kSceneId = 1;
constexpr int kObjectId = 1;
constexpr int kMaxFrames = 100'000;
constexpr double kMaxCount = 65535.0;  // of a 16-bit image

void validate(const SimulationOptions& options) {
    check_option("frames", options.num_frames, 1, kMaxFrames);
    check_option("frames per second", options.frames_per_second, 0.001, 1e4);
    // A depth of the least range must not round to 0 counts, which means no depth.
    check_option("depth scale [mm]", options.depth_scale_mm, 1e-4, options.sensor.min_range_m * 1e3);
    validate(options.camera);
    validate(options.sensor);
    validate(options.arm);
}

// What is the same in all frames.
struct Recording {
    const SimulationOptions& options;
    const Scene scene;
    const DepthSensor sensor;
    const std::vector<Pose> camera_from_object;
    const std::vector<Pose> camera_from_world;  // measured
    const fs::path scene_folder;
};

SensorNoise within_counts(SensorNoise sensor, double depth_scale_mm) {
    sensor.max_range_m = std::min(sensor.max_range_m, kMaxCount * depth_scale_mm * 1e-3);
    return sensor;
}

int measured_on(const Mask& silhouette, const DepthImage& depth) {
    int count = 0;
    for (std::size_t pixel = 0; pixel < silhouette.value.size(); ++pixel) {
        count += silhouette.value[pixel] != 0 && depth.depth_m[pixel] > 0.0F ? 1 : 0;
    }
    return count;
}

// Renders, measures and writes the images of one frame.
data_set::FrameRecord write_frame(const Recording& recording, int frame) {
    const SimulationOptions& options = recording.options;
    const auto index = static_cast<std::size_t>(frame);
    const RenderedFrame rendered = recording.scene.render(recording.camera_from_object[index], options.camera);
    const DepthImage depth = recording.sensor.measure(rendered.image, index);

    data_set::FrameRecord record;
    record.id = frame;
    record.camera = options.camera;
    record.depth_scale_mm = options.depth_scale_mm;
    record.camera_from_world = recording.camera_from_world[index];
    record.timestamp_s = frame / options.frames_per_second;
    record.objects = {rendered.truth};
    record.objects[0].object_id = kObjectId;
    record.objects[0].measured_pixels = measured_on(rendered.silhouette, depth);

    const fs::path& folder = recording.scene_folder;
    data_set::write_depth_png(data_set::depth_path(folder, frame), depth, options.depth_scale_mm);
    data_set::write_mask_png(data_set::mask_path(folder, frame, 0, true), rendered.visible);
    data_set::write_mask_png(data_set::mask_path(folder, frame, 0, false), rendered.silhouette);
    return record;
}

void write_models(const Mesh& mesh, const ModelExtent& extent, const fs::path& data_set_folder) {
    data_set::ModelInfo info;
    info.diameter_m = data_set::diameter_of(mesh.vertices_in_object);
    info.box_min_in_object_m = extent.box_min_in_object;
    info.box_max_in_object_m = extent.box_max_in_object;
    for (const char* name : {"models", "models_eval"}) {
        const fs::path folder = data_set_folder / name;
        data_set::create_folder(folder);
        save_ply(mesh, folder / "obj_000001.ply", LengthUnit::kMillimetre);
        data_set::write_models_info(folder / "models_info.json", {{kObjectId, info}});
    }
}

void write_lists(const std::vector<data_set::FrameRecord>& records, const fs::path& folder) {
    std::vector<data_set::TestTarget> targets;
    data_set::TumWriter truth(folder / "truth.tum");
    for (const data_set::FrameRecord& record : records) {
        const data_set::ObjectTruth& object = record.objects.front();
        truth.append(*record.timestamp_s, object.camera_from_object);
        if (object.visible_pixels > 0) targets.push_back({kSceneId, record.id, kObjectId, 1});
    }
    truth.close();
    data_set::write_test_targets(folder / "test_targets_bop19.json", targets);
}

// False where `frame_done` asked to stop.
bool write_frames(const Recording& recording, const std::function<bool()>& frame_done,
                  std::vector<data_set::FrameRecord>& records) {
    for (const char* name : {"depth", "mask", "mask_visib"}) data_set::create_folder(recording.scene_folder / name);
    records.resize(recording.camera_from_object.size());
    std::atomic<bool> stopped = false;
    std::mutex mutex;
    parallel_for(static_cast<int>(records.size()), recording.options.num_threads, [&](int frame) {
        if (stopped) return;
        records[static_cast<std::size_t>(frame)] = write_frame(recording, frame);
        const std::lock_guard lock(mutex);
        if (!frame_done()) stopped = true;
    });
    return !stopped;
}

}  // namespace

PinholeCamera default_camera() {
    return {640, 480, 600.0, 600.0, 319.5, 239.5};
}

SimulationSummary write_data_set(const Mesh& mesh, const Part& part, const SimulationOptions& options,
                                 const std::function<bool()>& frame_done) {
    validate(options);
    const std::vector<Pose> path =
        camera_path(options.scenario, part, options.camera, options.num_frames, options.seed);
    StagedFolder staged(options.data_set, options.replace,
                        {"camera.json", "models", "models_eval", "test", "test_targets_bop19.json", "truth.tum"});
    const fs::path scene_folder = staged.path() / "test" / "000001";
    const Recording recording{
        options,
        Scene(mesh, options.with_table),
        DepthSensor(within_counts(options.sensor, options.depth_scale_mm), options.camera, options.seed),
        path,
        measured_motion(path, options.arm, options.seed),
        scene_folder};
    SimulationSummary summary;
    std::vector<data_set::FrameRecord> records;
    if (!write_frames(recording, frame_done, records)) return summary;

    data_set::BopSceneWriter writer(scene_folder);
    for (const data_set::FrameRecord& record : records) {
        writer.add_frame(record);
        if (record.objects.front().measured_pixels == 0) ++summary.frames_without_part;
    }
    writer.finish();
    write_models(mesh, recording.scene.extent(), staged.path());
    write_lists(records, staged.path());
    staged.commit();
    summary.complete = true;
    return summary;
}

}  // namespace nearpose::simulate
