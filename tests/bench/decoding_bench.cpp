// Reading an image's files, apart from everything else: depth (16 bits) and mask of 640 x 480 pixels, PNG, from the
// page cache; beside it the same counts read as they lie in memory.
#include <unistd.h>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "apps/data_set/png_file.hpp"
#include "tests/bench/described.hpp"
#include "tests/bench/fixture.hpp"

namespace nearpose::bench {
namespace {

constexpr double kDepthScale_mm = 0.1;

// The files of the approach's middle frame, for as long as this lives.
class Files {
  public:
    Files() : folder_(std::filesystem::temp_directory_path() / ("nearpose_bench_" + std::to_string(getpid()))) {
        std::filesystem::create_directories(folder_);
        const Frame& frame = still().frame;
        data_set::write_depth_png(depth(), frame.depth, kDepthScale_mm);
        data_set::write_mask_png(mask(), frame.mask);
        const std::vector<std::uint16_t> counts = data_set::counts_from_depth(frame.depth, kDepthScale_mm).counts;
        std::ofstream(raw(), std::ios::binary)
            .write(reinterpret_cast<const char*>(counts.data()), static_cast<std::streamsize>(2 * counts.size()));
    }
    ~Files() { std::filesystem::remove_all(folder_); }
    Files(const Files&) = delete;
    Files& operator=(const Files&) = delete;

    std::filesystem::path depth() const { return folder_ / "depth.png"; }
    std::filesystem::path mask() const { return folder_ / "mask.png"; }
    std::filesystem::path raw() const { return folder_ / "depth.raw"; }

  private:
    std::filesystem::path folder_;
};

void raw(benchmark::State& state) {
    const Files files;
    const PinholeCamera& camera = still().camera;
    for (auto _ : state) {
        data_set::CountImage image{camera.width, camera.height, {}};
        image.counts.resize(static_cast<std::size_t>(camera.width) * camera.height);
        std::ifstream(files.raw(), std::ios::binary)
            .read(reinterpret_cast<char*>(image.counts.data()), static_cast<std::streamsize>(2 * image.counts.size()));
        benchmark::DoNotOptimize(data_set::depth_from_counts(image, kDepthScale_mm));
    }
    describe(state, 1.0, "unit=image");
}

void depth(benchmark::State& state) {
    const Files files;
    for (auto _ : state) benchmark::DoNotOptimize(data_set::read_depth_png(files.depth(), kDepthScale_mm));
    describe(state, 1.0, "unit=image");
}

void mask(benchmark::State& state) {
    const Files files;
    for (auto _ : state) benchmark::DoNotOptimize(data_set::read_mask_png(files.mask()));
    describe(state, 1.0, "unit=image");
}

BENCHMARK(raw)->Name("decoding/raw")->Unit(benchmark::kMillisecond);
BENCHMARK(depth)->Name("decoding/depth_png")->Unit(benchmark::kMillisecond);
BENCHMARK(mask)->Name("decoding/mask_png")->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace nearpose::bench
