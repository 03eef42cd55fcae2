#include "raycast/surface_samples.hpp"

#include "tests/raycast/shapes.hpp"

namespace nearpose::test {
namespace {

// Stratified along the area: each face of the box gets its share to within its two strata at the ends.
TEST(SurfaceSamples, AreDrawnInProportionToTheArea) {
    const Eigen::Vector3d half(0.05, 0.03, 0.08);
    const SurfaceSamples samples = sample_surface(make_box(half.cast<float>()), 10000, 1);
    ASSERT_EQ(samples.points_in_object.size(), 10000U);
    Eigen::Vector3i count = Eigen::Vector3i::Zero();
    for (std::size_t i = 0; i < 10000; ++i) {
        int axis = 0;
        samples.normals_in_object[i].cwiseAbs().maxCoeff(&axis);
        ++count[axis];
        const Eigen::Vector3d point = samples.points_in_object[i].cast<double>();
        ASSERT_NEAR(point[axis] * samples.normals_in_object[i][axis], half[axis], 1e-7);  // on the face, outwards
        ASSERT_LE((point.cwiseAbs() - half).maxCoeff(), 1e-7);
    }
    const Eigen::Vector3d area(half.y() * half.z(), half.x() * half.z(), half.x() * half.y());
    for (int axis = 0; axis < 3; ++axis) EXPECT_NEAR(count[axis], 10000.0 * area[axis] / area.sum(), 4.0);
}

TEST(SurfaceSamples, AreEvenWithinATriangle) {
    Mesh mesh;
    mesh.vertices_in_object = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    mesh.triangles = {{0, 1, 2}};
    Eigen::Vector3d mean = Eigen::Vector3d::Zero();
    int near_corner = 0;  // in the quarter of the area around the first corner
    for (const Eigen::Vector3f& point : sample_surface(mesh, 20000, 3).points_in_object) {
        mean += point.cast<double>() / 20000.0;
        if (point.x() + point.y() < 0.5F) ++near_corner;
    }
    EXPECT_LT((mean - Eigen::Vector3d(1, 1, 0) / 3.0).norm(), 0.01);
    EXPECT_NEAR(near_corner / 20000.0, 0.25, 0.02);
}

TEST(SurfaceSamples, DependOnTheSeedAlone) {
    const Mesh box = make_box({0.05F, 0.03F, 0.08F});
    EXPECT_EQ(sample_surface(box, 100, 5).points_in_object, sample_surface(box, 100, 5).points_in_object);
    EXPECT_NE(sample_surface(box, 100, 5).points_in_object, sample_surface(box, 100, 6).points_in_object);
}

TEST(SurfaceSamples, OfACloudAreItsPoints) {
    Mesh cloud;
    for (int i = 0; i < 10; ++i) cloud.vertices_in_object.emplace_back(static_cast<float>(i), 0.0F, 0.0F);
    EXPECT_THROW(sample_surface(cloud, 5, 1), std::invalid_argument);  // no normals
    cloud.vertex_normals_in_object.assign(10, {0, 0, 1});
    EXPECT_EQ(sample_surface(cloud, 100, 1).points_in_object, cloud.vertices_in_object);
    EXPECT_EQ(sample_surface(cloud, 5, 1).points_in_object[4].x(), 8.0F);
}

TEST(SurfaceSamples, RefuseNonsense) {
    EXPECT_THROW(sample_surface(make_square(1.0F), 0, 1), std::invalid_argument);
    EXPECT_THROW(sample_surface(make_square(0.0F), 10, 1), std::invalid_argument);
}

}  // namespace
}  // namespace nearpose::test
