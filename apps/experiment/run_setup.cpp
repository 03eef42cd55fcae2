#include "apps/experiment/run_setup.hpp"

#include <cmath>
#include <numbers>

#include "apps/data_set/bop_models.hpp"
#include "apps/data_set/model_diameter.hpp"
#include "apps/data_set/trajectory_tum.hpp"
#include "apps/depth_sensor/sensor_file.hpp"
#include "apps/experiment/cad_error.hpp"
#include "apps/part_model/model_input.hpp"
#include "apps/part_model/model_symmetries.hpp"
#include "raycast/mesh_loader.hpp"

namespace nearpose::experiment {
namespace {

namespace fs = std::filesystem;

constexpr double kRadians = std::numbers::pi / 180.0;

// Settings that always have a value: see completed().
double number(const Settings& settings, const char* name) {
    return std::get<double>(settings.at(name));
}

bool flag(const Settings& settings, const char* name) {
    return std::get<bool>(settings.at(name));
}

std::string word(const Settings& settings, const char* name) {
    return std::get<std::string>(settings.at(name));
}

std::optional<double> scaled(const Settings& settings, const char* name, double scale) {
    const std::optional<double> value = setting<double>(settings, name);
    return value ? std::optional(*value * scale) : std::nullopt;
}

std::optional<int> whole(const Settings& settings, const char* name) {
    const std::optional<double> value = setting<double>(settings, name);
    return value ? std::optional(static_cast<int>(*value)) : std::nullopt;
}

std::string cad_of(const Settings& settings) {
    return setting<std::string>(settings, "cad").value_or("true");
}

simulate::Disturbances disturbances_of(const Settings& settings) {
    simulate::Disturbances disturbances;
    disturbances.nonsense_frames = whole(settings, "nonsense_frames").value_or(0);
    disturbances.look_away = whole(settings, "look_away").value_or(0);
    disturbances.object_moves = setting<bool>(settings, "object_moves").value_or(false);
    disturbances.scene = simulate::scene_content_of(setting<std::string>(settings, "scene").value_or("part"));
    return disturbances;
}

Tolerance tolerance_of(const Settings& settings) {
    return {1e-3 * setting<double>(settings, "tolerance_mm").value_or(kTolerance_mm),
            kRadians * setting<double>(settings, "tolerance_deg").value_or(kTolerance_deg)};
}

simulate::ScenarioOptions path_options(const Settings& settings, const fs::path& folder) {
    simulate::ScenarioOptions path;
    path.far_m = scaled(settings, "far_mm", 1e-3);
    path.near_m = scaled(settings, "near_mm", 1e-3);
    path.conveyor_step_m = scaled(settings, "conveyor_mm", 1e-3);
    path.conveyor_turn_rad = scaled(settings, "conveyor_deg", kRadians);
    path.occlusion = setting<double>(settings, "occlusion");
    constexpr double kMaxNormError = 1e-3;  // of a quaternion of four digits
    if (const auto file = setting<std::string>(settings, "trajectory"))
        path.trajectory = data_set::read_tum(folder / *file, kMaxNormError);
    return path;
}

void set_sensor(const Settings& settings, const fs::path& folder, simulate::RecordingOptions& options) {
    if (const auto name = setting<std::string>(settings, "sensor")) {
        const auto& built_in = simulate::sensor_names();
        const bool known = std::find(built_in.begin(), built_in.end(), *name) != built_in.end();
        const fs::path file = folder / *name;
        const simulate::SensorDescription sensor =
            simulate::read_sensor(!known && fs::exists(file) ? file.string() : *name);
        options.camera = sensor.camera;
        options.depth_scale_mm = sensor.depth_scale_mm;
        options.sensor = sensor.noise;
        options.stereo = sensor.stereo;
    }
    options.sensor = simulate::scaled(options.sensor, number(settings, "noise_scale"));
    options.stereo = simulate::scaled(options.stereo, number(settings, "noise_scale"));
    options.material = setting<std::string>(settings, "material").value_or(options.material);
    const auto scale = static_cast<int>(number(settings, "image_scale"));
    PinholeCamera& camera = options.camera;
    camera.width /= scale;
    camera.height /= scale;
    camera.fx /= scale;
    camera.fy /= scale;
    camera.cx = (camera.cx + 0.5) / scale - 0.5;  // pixel centres are at whole numbers
    camera.cy = (camera.cy + 0.5) / scale - 0.5;
}

std::string part_key(const Settings& settings) {
    Settings key;
    for (const char* name : {"part", "model", "unit"}) {
        const auto found = settings.find(name);
        if (found != settings.end()) key.insert(*found);
    }
    return json_of(key);
}

simulate::EmbeddedPart load_part(const Settings& settings, const fs::path& folder) {
    const auto model = setting<std::string>(settings, "model");
    if (!model) return simulate::embedded_part(word(settings, "part"));
    program::ModelOptions options;
    options.model = folder / *model;
    options.unit = setting<std::string>(settings, "unit").value_or("");
    Mesh mesh = load_mesh(options.model, program::model_unit(options)).mesh;
    const simulate::Part part = simulate::box_part(extent_of(mesh));
    return {std::move(mesh), part};
}

std::unique_ptr<PartAssets> make_part(const Settings& settings, const fs::path& folder) {
    auto assets = std::make_unique<PartAssets>();
    assets->part = load_part(settings, folder);
    const Mesh& mesh = assets->part.mesh;
    data_set::ModelInfo info;
    info.diameter_m = data_set::diameter_of(mesh.vertices_in_object);
    info.box_min_in_object_m = assets->part.part.extent.box_min_in_object;
    info.box_max_in_object_m = assets->part.part.extent.box_max_in_object;
    assets->symmetries = program::find_symmetries(mesh);
    program::declare(assets->symmetries, info);
    assets->shape = evaluation::shape_of(info, mesh);
    return assets;
}

void check_row(TableKind kind, const Settings& settings, const fs::path& folder) {
    if (settings.count("model") != 0 && settings.count("part") != 0)
        throw std::invalid_argument("part and model name two parts: leave one out");
    if (settings.count("unit") != 0 && settings.count("model") == 0)
        throw std::invalid_argument("unit belongs to model: a built-in part needs none");
    const auto model = setting<std::string>(settings, "model");
    if (model && !fs::exists(folder / *model))
        throw std::invalid_argument("model " + (folder / *model).string() + ": there is no such file");
    if (kind == TableKind::kViews) {
        compare::validate(view_cell(settings, 1));
        return;
    }
    simulate::validate(recording_options(settings, 1, folder));
    const program::EstimatorSetup setup = estimator_setup(settings, 1);
    program::make_method(setup);
    program::make_solver(setup);
    if (setup.view_samples && !program::is_rasteriser(setup.views))
        throw std::invalid_argument("view_samples belongs to rasterised views, not " + setup.views);
    const std::string scene = setting<std::string>(settings, "scene").value_or("part");
    if (starts_at_truth(settings) && scene != "part")
        throw std::invalid_argument("start truth: there is no true pose in the scene " + scene);
    if (is_drawn(cad_of(settings))) with_cad_error(load_part(settings, folder).mesh, cad_of(settings), 1);
}

}  // namespace

simulate::RecordingOptions recording_options(const Settings& settings, std::uint64_t seed, const fs::path& folder) {
    simulate::RecordingOptions options;
    options.scenario = simulate::scenario_of(word(settings, "scenario"));
    options.path = path_options(settings, folder);
    options.num_frames = whole(settings, "frames").value_or(0);
    options.frames_per_second = number(settings, "fps");
    options.seed = seed;
    set_sensor(settings, folder, options);
    options.arm = {number(settings, "arm_mm") * 1e-3, number(settings, "arm_deg") * kRadians,
                   number(settings, "hand_eye_mm") * 1e-3, number(settings, "hand_eye_deg") * kRadians,
                   number(settings, "time_offset_ms") * 1e-3};
    options.mask = {static_cast<int>(number(settings, "mask_grow")), static_cast<int>(number(settings, "mask_bleed"))};
    options.dropped_fraction = number(settings, "dropped");
    options.disturbances = disturbances_of(settings);
    const std::string fault = setting<std::string>(settings, "fault").value_or(kNoFault);
    if (fault != kNoFault) options.faults.push_back(simulate::parse_fault(fault));
    options.with_table = flag(settings, "table");
    options.part_name = setting<std::string>(settings, "part").value_or("");
    return options;
}

program::EstimatorSetup estimator_setup(const Settings& settings, std::uint64_t seed) {
    program::EstimatorSetup setup;
    setup.method = word(settings, "method");
    setup.views = word(settings, "views");
    setup.particles = static_cast<int>(number(settings, "particles"));
    setup.threads = 1;  // the cores are busy with other runs
    setup.seed = seed;
    setup.rounds = whole(settings, "rounds");
    setup.consensus_draws = whole(settings, "consensus_draws");
    setup.overlap = setting<bool>(settings, "overlap");
    setup.residual = setting<std::string>(settings, "residual");
    setup.gradient = flag(settings, "gradient");
    setup.without = setting<std::string>(settings, "without").value_or("nothing");
    setup.view_samples = whole(settings, "view_samples");
    setup.use_mask = flag(settings, "mask");
    setup.use_control = flag(settings, "control");
    setup.tolerance = tolerance_of(settings);
    return setup;
}

bool starts_at_truth(const Settings& settings) {
    return setting<std::string>(settings, "start").value_or("none") == "truth";
}

evaluation::SummaryOptions summary_options(const Settings& settings) {
    evaluation::SummaryOptions options;
    options.burn_in = static_cast<int>(number(settings, "burn_in"));
    options.tolerance = tolerance_of(settings);
    return options;
}

compare::ViewCell view_cell(const Settings& settings, std::uint64_t seed) {
    compare::ViewCell cell;
    cell.views = word(settings, "views");
    cell.view_samples = static_cast<int>(number(settings, "view_samples"));
    cell.distance_mm = number(settings, "distance_mm");
    cell.max_rays = static_cast<int>(number(settings, "max_rays"));
    cell.timed_views = static_cast<int>(number(settings, "timed_views"));
    cell.seed = seed;
    return cell;
}

void check(const Description& description) {
    for (const TableSpec& table : description.tables) {
        for (const RowSpec& row : table.rows) {
            try {
                check_row(table.kind, row.settings, description.file.parent_path());
            } catch (const std::exception& error) {
                throw std::runtime_error(description.file.string() + ": table " + table.name + ", row \"" + row.label +
                                         "\": " + error.what());
            }
        }
    }
}

const PartAssets& Workshop::part_unlocked(const Settings& settings) {
    std::unique_ptr<PartAssets>& assets = parts_[part_key(settings)];
    if (!assets) assets = make_part(settings, folder_);
    return *assets;
}

const PartAssets& Workshop::part(const Settings& settings) {
    const std::lock_guard lock(mutex_);
    return part_unlocked(settings);
}

std::shared_ptr<const ViewGenerator> Workshop::views(const Settings& settings, std::uint64_t seed) {
    const program::EstimatorSetup setup = estimator_setup(settings, seed);
    const std::string cad = cad_of(settings);
    if (is_drawn(cad)) return program::make_view_generator(setup, with_cad_error(part(settings).part.mesh, cad, seed));
    const std::lock_guard lock(mutex_);
    const std::string key = part_key(settings) + setup.views + std::to_string(setup.view_samples.value_or(0)) + cad;
    std::shared_ptr<const ViewGenerator>& views = views_[key];
    if (!views)
        views = program::make_view_generator(setup, with_cad_error(part_unlocked(settings).part.mesh, cad, seed));
    return views;
}

const compare::ViewBench& Workshop::view_bench(const Settings& settings) {
    const std::lock_guard lock(mutex_);
    std::unique_ptr<compare::ViewBench>& bench = benches_[part_key(settings)];
    const PartAssets& assets = part_unlocked(settings);
    if (!bench) {
        bench = std::make_unique<compare::ViewBench>(assets.part.mesh, assets.part.part, simulate::default_camera());
    }
    return *bench;
}

}  // namespace nearpose::experiment
