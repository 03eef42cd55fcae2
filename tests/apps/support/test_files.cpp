#include "tests/apps/support/test_files.hpp"

#include <unistd.h>

#include <clocale>
#include <cstdio>
#include <cstdlib>

#include "apps/data_set/bop_writer.hpp"

namespace nearpose::data_set::testing_files {
namespace {

bool has_decimal_comma() {
    std::array<char, 16> text{};
    std::snprintf(text.data(), text.size(), "%.1f", 0.5);
    return std::string_view(text.data()) == "0,5";
}

bool set_comma_locale() {
    for (const char* name : {"de_DE.UTF-8", "de_DE.utf8", "de_DE", "fr_FR.UTF-8"}) {
        if (std::setlocale(LC_ALL, name) != nullptr && has_decimal_comma()) return true;
    }
    return false;
}

}  // namespace

std::filesystem::path write_small_scene(const std::filesystem::path& folder) {
    const std::filesystem::path scene = folder / "test" / "000005";
    BopSceneWriter writer(scene);
    for (int id = 0; id < 3; ++id) {
        FrameRecord record;
        record.id = id;
        record.camera = {4, 3, 500.0, 501.0, 1.5, 1.25};
        record.depth_scale_mm = 0.5;
        const float depth_m = 0.0005F * static_cast<float>(id + 1);
        writer.add_frame(record, {4, 3, std::vector<float>(12, depth_m)});
    }
    writer.finish();
    return scene;
}

CommaLocale::CommaLocale() : before_(std::setlocale(LC_ALL, nullptr)) {
    ok_ = set_comma_locale();
    if (ok_) return;
    // Few machines have more than the C locale; one is made where its sources are installed, once for all tests.
    const std::filesystem::path folder = std::filesystem::path(testing::TempDir()) / "nearpose_locales";
    if (!std::filesystem::exists(folder)) {
        const std::filesystem::path own = folder.string() + std::to_string(::getpid());
        std::filesystem::create_directories(own);
        const std::string name = (own / "de_DE.UTF-8").string();
        const std::string command = "localedef -i de_DE -f UTF-8 '" + name + "' >/dev/null 2>&1";
        if (std::system(command.c_str()) != 0) return;
        std::error_code another_test_was_first;
        std::filesystem::rename(own, folder, another_test_was_first);
    }
    ::setenv("LOCPATH", folder.c_str(), 1);
    ok_ = set_comma_locale();
}

CommaLocale::~CommaLocale() {
    std::setlocale(LC_ALL, before_.c_str());
}

}  // namespace nearpose::data_set::testing_files
