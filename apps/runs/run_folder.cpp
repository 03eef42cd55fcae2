#include "apps/runs/run_folder.hpp"

#include <nlohmann/json.hpp>

#include "apps/base/file_io.hpp"
#include "apps/base/text_split.hpp"
#include "apps/base/version.hpp"
#include "apps/data_set/json_file.hpp"

namespace nearpose::program {
namespace {

using Json = nlohmann::ordered_json;
using data_set::JsonValue;

Json path_json(const std::filesystem::path& path) {
    if (path.empty()) return nullptr;
    if (path == "-") return "-";
    return std::filesystem::absolute(path).lexically_normal().string();
}

Json text_json(const std::string& text) {
    return text.empty() ? Json(nullptr) : Json(text);
}

Json number_json(const std::optional<int>& number) {
    return number ? Json(*number) : Json(nullptr);
}

// Keys are the names of the options; null: not given.
Json options_json(const EstimateOptions& options) {
    return {{"scene", path_json(options.scene)},
            {"clouds", path_json(options.clouds)},
            {"camera", path_json(options.camera)},
            {"models", path_json(options.model.models)},
            {"object", options.model.object},
            {"model", path_json(options.model.model)},
            {"unit", text_json(options.model.unit)},
            {"keep-largest", options.model.keep_largest},
            {"no-mask", options.no_mask},
            {"mask-first-frame", options.mask_first_frame},
            {"mask-index", number_json(options.mask_index)},
            {"no-control", options.no_control},
            {"set-up", path_json(options.set_up)},
            {"self-calibrate", options.self_calibrate},
            {"first", number_json(options.first)},
            {"last", number_json(options.last)},
            {"scene-id", number_json(options.scene_id)},
            {"fps", options.fps},
            {"views", options.views},
            {"method", options.method},
            {"symmetries", options.symmetries},
            {"particles", number_json(options.particles)},
            {"threads", options.threads},
            {"seed", options.seed},
            {"initial-pose", path_json(options.initial_pose)},
            {"initial-sigma-mm", options.initial_sigma_mm},
            {"initial-sigma-deg", options.initial_sigma_deg},
            {"tolerance-mm", options.tolerance_mm},
            {"tolerance-deg", options.tolerance_deg},
            {"budget-ms", options.budget_ms},
            {"run", path_json(options.outputs.run)},
            {"out", path_json(options.outputs.out)},
            {"log", path_json(options.outputs.log)},
            {"trajectory", path_json(options.outputs.trajectory)},
            {"trajectory-frame", options.outputs.trajectory_frame},
            {"pictures", path_json(options.outputs.pictures)}};
}

// What `nearpose --version` says, line by line: a name, spaces, a value.
Json program_json() {
    Json program = Json::object();
    const std::string text = version_text();  // the lines are parts of it
    for (const std::string_view line : data_set::lines(text)) {
        const std::size_t space = line.find(' ');
        if (space == line.npos) continue;
        const std::size_t value = line.find_first_not_of(' ', space);
        program[std::string(line.substr(0, space))] = std::string(line.substr(value));
    }
    return program;
}

std::string text_of(const JsonValue& options, const char* key) {
    const auto value = options.find(key);
    return value && value->is_string() ? value->text() : std::string();
}

std::optional<int> integer_of(const JsonValue& options, const char* key) {
    const auto value = options.find(key);
    return value && value->is_number() ? std::optional<int>(value->integer()) : std::nullopt;
}

bool flag_of(const JsonValue& options, const char* key) {
    const auto value = options.find(key);
    return value && value->flag();
}

EstimateOptions options_of(const JsonValue& json) {
    EstimateOptions options;
    options.scene = text_of(json, "scene");
    options.clouds = text_of(json, "clouds");
    options.camera = text_of(json, "camera");
    options.model.models = text_of(json, "models");
    options.model.object = json.at("object").integer();
    options.model.model = text_of(json, "model");
    options.model.unit = text_of(json, "unit");
    options.model.keep_largest = flag_of(json, "keep-largest");
    options.no_mask = flag_of(json, "no-mask");
    options.mask_first_frame = flag_of(json, "mask-first-frame");
    options.mask_index = integer_of(json, "mask-index");
    options.no_control = flag_of(json, "no-control");
    options.set_up = text_of(json, "set-up");
    options.self_calibrate = flag_of(json, "self-calibrate");
    options.first = integer_of(json, "first");
    options.last = integer_of(json, "last");
    options.scene_id = integer_of(json, "scene-id");
    options.fps = json.at("fps").number();
    options.views = json.at("views").text();
    options.method = json.at("method").text();
    if (const auto symmetries = json.find("symmetries")) options.symmetries = symmetries->text();
    options.particles = integer_of(json, "particles");
    options.threads = json.at("threads").integer();
    options.seed = json.at("seed").unsigned_integer();
    options.initial_pose = text_of(json, "initial-pose");
    options.initial_sigma_mm = json.at("initial-sigma-mm").number();
    options.initial_sigma_deg = json.at("initial-sigma-deg").number();
    options.tolerance_mm = json.at("tolerance-mm").number();
    options.tolerance_deg = json.at("tolerance-deg").number();
    if (const auto budget = json.find("budget-ms")) options.budget_ms = budget->number();
    options.outputs = {text_of(json, "run"),        text_of(json, "out"),      text_of(json, "log"),
                       text_of(json, "trajectory"), text_of(json, "pictures"), text_of(json, "trajectory-frame")};
    return options;
}

}  // namespace

void write_run_record(const std::filesystem::path& folder, const EstimateOptions& options, int scene_id) {
    const Json record = {{"format", 1},
                         {"content", "nearpose run"},
                         {"program", program_json()},
                         {"scene_id", scene_id},
                         {"options", options_json(options)}};
    data_set::write_file_atomically(folder / kRunFile,
                                    record.dump(2, ' ', false, Json::error_handler_t::replace) + "\n");
}

RunRecord read_run_record(const std::filesystem::path& folder) {
    const data_set::JsonFile file(folder / kRunFile);
    const JsonValue root = file.root();
    if (root.at("format").integer() != 1) throw root.at("format").error("is not 1, the only one that is known");
    RunRecord record;
    record.options = options_of(root.at("options"));
    record.scene_id = root.at("scene_id").integer();
    for (const auto& [name, value] : root.at("program").members()) record.program.emplace_back(name, value.text());
    return record;
}

}  // namespace nearpose::program
