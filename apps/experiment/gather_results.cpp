// results_of: tables and curves from finished cells.
#include <stdexcept>

#include "apps/base/degrees.hpp"
#include "apps/error_measures/curve.hpp"
#include "apps/experiment/experiment.hpp"
#include "apps/experiment/run_setup.hpp"

namespace nearpose::experiment {
namespace {

namespace fs = std::filesystem;

tables::Row row_of(const TableSpec& table, const RowSpec& row, const fs::path& out) {
    std::vector<Figures> runs;
    for (const std::uint64_t seed : table.seeds) {
        const CellKey key{table.name, row.slug, seed};
        const auto cell = finished_cell(out, key, row.settings);
        if (!cell) throw std::runtime_error((cell_folder(out, key) / "cell.json").string() + ": is not finished");
        runs.push_back(cell->figures);
    }
    tables::Row result{row.label, static_cast<int>(runs.size()), {}};
    for (const std::string& column : table.columns) result.entries.push_back(entry_of(table.kind, column, runs));
    return result;
}

std::optional<double> x_of(const CurveSpec& curve, const evaluation::Visibility& visibility) {
    if (curve.x == "distance") return 1e3 * visibility.distance_m;
    if (curve.x == "visible_volume") return 1e6 * visibility.visible_volume_m3;
    if (!visibility.visible_fraction) return std::nullopt;
    return 1e2 * *visibility.visible_fraction;
}

void add_points(const CurveSpec& curve, const std::vector<evaluation::FrameErrors>& frames, std::size_t burn_in,
                std::vector<evaluation::CurvePoint>& points) {
    for (std::size_t i = burn_in; i < frames.size(); ++i) {
        if (!frames[i].errors || !frames[i].visibility || frames[i].shown != evaluation::Shown::kPart) continue;
        const std::optional<double> x = x_of(curve, *frames[i].visibility);
        const evaluation::PoseErrors& errors = *frames[i].errors;
        const double y = curve.y == "translation" ? 1e3 * errors.translation_m : kDegrees * errors.rotation_rad;
        if (x) points.push_back({*x, y});
    }
}

tables::CurveSet empty_set(const CurveSpec& curve) {
    const bool translation = curve.y == "translation";
    const std::string what = translation ? "Translation error" : "Rotation error";
    tables::CurveSet set;
    set.y_title = translation ? "translation error [mm]" : "rotation error [deg]";
    set.x_logarithmic = curve.logarithmic;
    if (curve.x == "distance") {
        set.title = what + " against distance";
        set.x_title = "distance of the visible points [mm]";
    } else if (curve.x == "visible_volume") {
        set.title = what + " against the visible volume";
        set.x_title = "volume of the visible points' ellipsoid [cm^3]";
    } else {
        set.title = what + " against the visible fraction";
        set.x_title = "visible fraction of the silhouette [%]";
    }
    return set;
}

// Frames are read once for all curves of a row.
std::vector<tables::CurveSet> curve_sets_of(const TableSpec& table, const fs::path& out) {
    std::vector<tables::CurveSet> sets;
    for (const CurveSpec& curve : table.curves) sets.push_back(empty_set(curve));
    if (sets.empty()) return sets;
    for (const RowSpec& row : table.rows) {
        const int usual_burn_in = summary_options(row.settings).burn_in;
        std::vector<std::vector<evaluation::CurvePoint>> points(sets.size());
        for (const std::uint64_t seed : table.seeds) {
            const auto frames = read_cell_frames(out, {table.name, row.slug, seed});
            for (std::size_t c = 0; c < sets.size(); ++c) {
                const int burn_in = table.curves[c].burn_in.value_or(usual_burn_in);
                add_points(table.curves[c], frames, static_cast<std::size_t>(burn_in), points[c]);
            }
        }
        for (std::size_t c = 0; c < sets.size(); ++c) {
            const CurveSpec& spec = table.curves[c];
            sets[c].curves.push_back(
                evaluation::curve_of(row.label, points[c], spec.low, spec.high, spec.bins, spec.logarithmic));
        }
    }
    return sets;
}

}  // namespace

tables::Results results_of(const Description& description, const fs::path& out) {
    tables::Results results;
    results.name = description.name;
    results.command = "nearpose experiment " + description.file.filename().string() + " --out FOLDER";
    for (const TableSpec& spec : description.tables) {
        tables::Table& table = results.tables.emplace_back();
        table.name = spec.name;
        table.title = spec.title;
        table.text = spec.text;
        for (const std::string& column : spec.columns) table.columns.push_back(heading_of(spec.kind, column));
        for (const RowSpec& row : spec.rows) table.rows.push_back(row_of(spec, row, out));
        table.curve_sets = curve_sets_of(spec, out);
    }
    return results;
}

}  // namespace nearpose::experiment
