// Cells of the comparison of views.
#include "apps/view_quality/view_cell.hpp"

#include "apps/runs/estimator_setup.hpp"
#include "apps/scenes/parts.hpp"
#include "apps/scenes/recording.hpp"
#include "raycast/nested_spheres_generator.hpp"
#include "raycast/raster_view_generator.hpp"
#include "tests/raycast/shapes.hpp"

namespace nearpose::compare {
namespace {

ViewBench box_bench() {
    const Mesh box = test::make_box({0.1F, 0.06F, 0.05F});
    return {box, simulate::box_part(extent_of(box)), {320, 240, 300.0, 300.0, 159.5, 119.5}};
}

double number(const std::vector<NamedNumber>& numbers, const std::string& name) {
    for (const NamedNumber& entry : numbers) {
        if (entry.name == name) return entry.value;
    }
    ADD_FAILURE() << "no number " << name;
    return -1.0;
}

ViewCell quick(const std::string& views) {
    ViewCell cell;
    cell.views = views;
    cell.view_samples = 500;
    cell.max_rays = 500;
    cell.viewpoints = 40;
    cell.timed_views = 20;
    return cell;
}

TEST(ViewCell, SaysTheSameOfTheSameSettings) {
    const ViewBench bench = box_bench();
    for (const std::string& views : program::view_names()) {
        const auto first = bench.numbers(quick(views));
        const auto again = box_bench().numbers(quick(views));
        for (const char* name : {"points_per_view", "pixels_per_view", "wrong_percent", "hidden_percent",
                                 "missing_percent", "mean_distance_mm", "distance_95_mm", "max_distance_mm"}) {
            EXPECT_EQ(number(first, name), number(again, name)) << views << " " << name;
        }
        EXPECT_GT(number(first, "cpu_ms_per_200_views"), 0.0);
        EXPECT_GT(number(first, "cpu_ratio_to_raycast"), 0.0);
    }
    EXPECT_LT(number(bench.numbers(quick("raycast")), "missing_percent"), 1.0);
    EXPECT_GT(number(bench.numbers(quick("raster")), "missing_percent"), 30.0);
}

// The seed alone says where the camera looks from: every generator meets the same pixels.
TEST(ViewCell, AllGeneratorsLookFromTheSamePlace) {
    const ViewBench bench = box_bench();
    ViewCell cell = quick("raycast");
    cell.timed_views = 0;
    const double pixels = bench.quality(cell).pixels_per_view;
    cell.views = "raster";
    EXPECT_EQ(bench.quality(cell).pixels_per_view, pixels);
    cell.seed = 2;
    EXPECT_NE(bench.quality(cell).pixels_per_view, pixels);
}

// The middle of the image shows the aimed point, at the cell's distance.
TEST(ViewCell, LooksFromTheSweepsLineOfSight) {
    const auto part = simulate::embedded_part("bracket");
    const ViewBench bench(part.mesh, part.part, simulate::default_camera());
    simulate::RecordingOptions options;
    options.scenario = simulate::Scenario::kSweep;
    options.num_frames = 2;
    options.seed = 5;
    options.path.far_m = options.path.near_m = 0.2;
    const Pose pose = simulate::Recording(part.mesh, part.part, options).frame(0).camera_from_object;
    ViewCell cell = quick("raster");
    cell.distance_mm = 200.0;
    cell.seed = 5;
    cell.timed_views = 0;
    const RasterViewGenerator raster(part.mesh, {500, 1});
    const ViewQuality expected =
        view_quality(raster, EmbreeScene(part.mesh), {simulate::default_camera(), 500, 0}, {&pose, 1});
    const ViewQuality quality = bench.quality(cell);
    EXPECT_EQ(quality.points_per_view, expected.points_per_view);
    EXPECT_EQ(quality.wrong_share, expected.wrong_share);
    EXPECT_EQ(quality.mean_distance_m, expected.mean_distance_m);
}

TEST(ViewCell, StoredImagesAreAsDenseAsTheSamples) {
    const ViewBench bench = box_bench();
    const double area_m2 = 8.0 * (0.1 * 0.06 + 0.06 * 0.05 + 0.05 * 0.1);
    const double diameter_m = 2.0 * Eigen::Vector3d(0.1, 0.06, 0.05).norm();
    for (const double radius : {0.6, 2.0}) {
        const double half_angle = std::asin(0.5 / radius);
        const double side_m = 2.0 * radius * diameter_m * std::tan(half_angle);  // of the image, at the centre
        const double pixel_m = side_m / bench.sphere_image_size(20000, radius);
        EXPECT_NEAR(pixel_m, std::sqrt(area_m2 / 20000.0), 0.01 * pixel_m);
    }
}

TEST(ViewCell, RefusesWhatItCannotDo) {
    const ViewBench bench = box_bench();
    const auto refuses = [&](const ViewCell& cell) { EXPECT_THROW(bench.numbers(cell), std::invalid_argument); };
    refuses(quick("photographs"));
    ViewCell cell = quick("raster");
    cell.view_samples = 0;
    refuses(cell);
    cell = quick("raycast");
    cell.distance_mm = 5.0;
    refuses(cell);
    cell.distance_mm = std::nan("");
    refuses(cell);
}

TEST(NestedSpheres, TakeTheSphereNearestToTheCamera) {
    const Mesh box = test::make_box({0.1F, 0.06F, 0.05F});
    const NestedSpheresGenerator nested(box, {{20, 0.6, 16}, {20, 1.2, 24}, {20, 2.4, 32}});
    const double diameter_m = nested.extent().diameter_m();
    for (const auto& [diameters, image_size] :
         {std::pair{0.3, 16}, {0.8, 16}, {0.9, 24}, {1.6, 24}, {1.8, 32}, {50.0, 32}}) {
        const Pose pose{Eigen::Quaterniond::Identity(), {0.0, 0.0, diameters * diameter_m}};
        EXPECT_EQ(nested.sphere_of(pose).stored_camera().width, image_size) << diameters;
        const SphereViewGenerator& sphere = nested.sphere_of(pose);
        const View view = nested.generate(pose, test::small_camera());
        EXPECT_EQ(view.points_in_object, sphere.generate(pose, test::small_camera()).points_in_object);
    }
    EXPECT_THROW(NestedSpheresGenerator(box, {}), std::invalid_argument);
    Pose broken;
    broken.translation.x() = std::nan("");
    EXPECT_THROW(nested.generate(broken, test::small_camera()), std::invalid_argument);
}

}  // namespace
}  // namespace nearpose::compare
