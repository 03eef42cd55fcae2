// Prints what benchmarks found: medians of the CPU time of a unit, ratios to the baselines of the same run, exponents.
// usage: nearpose_bench_table [--check] results.json...     --check: exit 1 where a goal is missed
// What is compared with what stands in the benchmarks' labels, see described.hpp.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <iostream>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>
#include <stdexcept>
#include <string>
#include <tuple>
#include <vector>

namespace {

using Json = nlohmann::json;

double median(std::vector<double> values) {
    std::sort(values.begin(), values.end());
    const std::size_t n = values.size();
    return 0.5 * (values[(n - 1) / 2] + values[n / 2]);
}

struct Result {
    std::string name;
    std::map<std::string, std::string> words;  // of the label
    std::vector<double> cpu_s;                 // of a unit, one entry a repetition
    std::vector<double> bare_ratios;           // likewise, where it has them
    Json last;                                 // for its other counters

    double median_s() const { return median(cpu_s); }
    double spread() const {
        const auto [least, most] = std::minmax_element(cpu_s.begin(), cpu_s.end());
        return (*most - *least) / median_s();
    }
    std::string word(const std::string& key) const {
        const auto found = words.find(key);
        return found == words.end() ? "" : found->second;
    }
};

struct Table {
    std::vector<Result> results;

    Result& named(const std::string& name) {
        for (Result& result : results)
            if (result.name == name) return result;
        results.push_back({name, {}, {}, {}, {}});
        return results.back();
    }
    const Result* find(const std::string& name) const {
        for (const Result& result : results)
            if (result.name == name) return &result;
        return nullptr;
    }
};

double seconds_of(const Json& run) {
    static const std::map<std::string, double> seconds{{"ns", 1e-9}, {"us", 1e-6}, {"ms", 1e-3}, {"s", 1.0}};
    return run.at("cpu_time").get<double>() * seconds.at(run.at("time_unit").get<std::string>());
}

// The library's own aggregates are left out: medians are taken here, over all files.
void read(const std::string& file, Table& table) {
    std::ifstream stream(file);
    const Json json = Json::parse(stream);
    for (const Json& run : json.at("benchmarks")) {
        if (run.value("run_type", "") != "iteration") continue;
        if (run.value("error_occurred", false))
            throw std::runtime_error(run.at("name").get<std::string>() + ": " + run.value("error_message", ""));
        std::string name = run.at("run_name");
        for (const char* suffix : {"/iterations:", "/repeats:", "/process_time"})
            name = name.substr(0, name.find(suffix));
        Result& result = table.named(name);
        result.cpu_s.push_back(seconds_of(run) / run.value("units", 1.0));
        if (run.contains("bare_ratio")) result.bare_ratios.push_back(run.at("bare_ratio"));
        result.last = run;
        std::istringstream label(run.value("label", ""));
        for (std::string word; label >> word;) {
            const std::size_t equals = word.find('=');
            if (equals != std::string::npos) result.words[word.substr(0, equals)] = word.substr(equals + 1);
        }
    }
}

// Interleaved repetitions come in any order: by name, numbers at its end by size.
void sort(Table& table) {
    const auto key = [](const Result& result) {
        const std::size_t slash = result.name.rfind('/') + 1;
        const double number = std::strtod(result.name.c_str() + slash, nullptr);
        return std::tuple(result.name.substr(0, slash), number, result.name);
    };
    std::sort(table.results.begin(), table.results.end(),
              [&](const Result& a, const Result& b) { return key(a) < key(b); });
}

std::string text(const char* format, double value) {
    char buffer[64];
    std::snprintf(buffer, sizeof buffer, format, value);
    return buffer;
}

std::string time_text(double seconds) {
    if (seconds < 1e-3) return text("%.2f us", 1e6 * seconds);
    return seconds < 1.0 ? text("%.2f ms", 1e3 * seconds) : text("%.2f s", seconds);
}

// Says in `verdict` whether a goal is met, and returns that.
bool judge(const std::string& what, bool met, std::string& verdict) {
    verdict += (verdict.empty() ? "" : ", ") + what + (met ? ": met" : ": MISSED");
    return met;
}

bool print_row(const Result& result, const Table& table) {
    const double median_s = result.median_s();
    std::string naive, bare, verdict;
    bool met = true;
    if (const Result* baseline = table.find(result.word("naive"))) {
        const double ratio = baseline->median_s() / median_s;
        naive = text("%.1f x", ratio);
        if (const std::string goal = result.word("naive_least"); !goal.empty())
            met &= judge("naive at least " + goal + " x", ratio >= std::stod(goal), verdict);
    }
    if (const Result* baseline = table.find(result.word("bare"))) {
        const double ratio = result.bare_ratios.empty() ? median_s / baseline->median_s() : median(result.bare_ratios);
        bare = text("%.2f", ratio);
        if (const std::string goal = result.word("bare_most"); !goal.empty())
            met &= judge("bare at most " + goal, ratio <= std::stod(goal), verdict);
    }
    if (const std::string goal = result.word("memory_most"); !goal.empty()) {
        const double peak_mb = result.last.at("peak_mb");
        met &= judge(text("%.0f MB of ", peak_mb) + goal, peak_mb <= std::stod(goal), verdict);
    }
    std::string details;
    for (const char* counter : {"x", "points", "median_frame_ms", "last_error_mm", "pairs", "accepted_share",
                                "within_budget_share", "reduced_share", "median_elapsed_ms"})
        if (result.last.contains(counter))
            details += std::string(" ") + counter + text(" %.4g", result.last.at(counter).get<double>());
    std::printf("| %-28s | %10s | %-14s | %5.1f %% | %9s | %6s | %s%s |\n", result.name.c_str(),
                time_text(median_s).c_str(), result.word("unit").c_str(), 100.0 * result.spread(), naive.c_str(),
                bare.c_str(), verdict.c_str(), details.c_str());
    return met;
}

// Of cost ~ x^exponent: the least-squares slope of the logarithms, over all sizes.
bool print_exponent(const std::string& group, const std::vector<const Result*>& sizes) {
    double mean_x = 0.0, mean_y = 0.0, xx = 0.0, xy = 0.0;
    const auto n = static_cast<double>(sizes.size());
    const auto x_of = [](const Result& size) { return std::log(size.last.at("x").get<double>()); };
    const auto y_of = [](const Result& size) { return std::log(size.median_s()); };
    for (const Result* size : sizes) mean_x += x_of(*size) / n, mean_y += y_of(*size) / n;
    for (const Result* size : sizes) {
        xx += (x_of(*size) - mean_x) * (x_of(*size) - mean_x);
        xy += (x_of(*size) - mean_x) * (y_of(*size) - mean_y);
    }
    const Result& largest = *sizes.back();
    const Result& before = *sizes[sizes.size() - 2];
    const double steepest = (y_of(largest) - y_of(before)) / (x_of(largest) - x_of(before));
    std::string verdict;
    const std::string goal = largest.word("exponent_most");
    const bool met = judge("at most " + goal, std::max(xy / xx, steepest) <= std::stod(goal), verdict);
    std::printf("| %-28s | exponent %.2f over all sizes, %.2f between the two largest | %s |\n", group.c_str(), xy / xx,
                steepest, verdict.c_str());
    return met;
}

bool print(const Table& table) {
    bool met = true;
    std::printf("| %-28s | %10s | %-14s | %7s | %9s | %6s | goals, details |\n", "benchmark", "CPU", "of one", "spread",
                "naive /", "/ bare");
    std::printf("|---|---|---|---|---|---|---|\n");
    std::map<std::string, std::vector<const Result*>> groups;
    for (const Result& result : table.results) {
        met &= print_row(result, table);
        if (!result.word("exponent_most").empty())
            groups[result.name.substr(0, result.name.rfind('/'))].push_back(&result);
    }
    std::printf("\n");
    for (auto& [group, sizes] : groups) {
        if (sizes.size() < 2) continue;
        std::sort(sizes.begin(), sizes.end(), [](const Result* a, const Result* b) {
            return a->last.at("x").get<double>() < b->last.at("x").get<double>();
        });
        met &= print_exponent(group, sizes);
    }
    return met;
}

}  // namespace

int main(int argc, char** argv) {
    try {
        bool check = false;
        Table table;
        for (int k = 1; k < argc; ++k) {
            if (std::string(argv[k]) == "--check")
                check = true;
            else
                read(argv[k], table);
        }
        sort(table);
        const bool met = print(table);
        return check && !met ? 1 : 0;
    } catch (const std::exception& error) {
        std::cerr << "nearpose_bench_table: " << error.what() << "\n";
        return 2;
    }
}
