#include "core/search/point_pair_table.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/search/surfels.hpp"

namespace nearpose {
namespace {

constexpr int kDistanceCells = 10, kAngleCells = 18;  // 10 degrees
constexpr int kMaxPairAnchors = 1000;                 // their pairs are a million

// Which of the cells of equal angle a cosine lies in. Cosines come in bins so narrow that each meets at most one border
// of the cells: a look-up instead of an arc cosine.
class AngleCells {
  public:
    AngleCells() {
        for (int cell = 0; cell < kAngleCells; ++cell)
            smallest_cosine_[cell] = static_cast<float>(std::cos(M_PI * (cell + 1) / kAngleCells));
        for (int bin = 0, cell = kAngleCells - 1; bin < kBins; ++bin) {
            const float largest = static_cast<float>(bin + 1) / kBinsPerUnit - 1.0F;
            while (cell > 0 && largest > smallest_cosine_[cell - 1]) --cell;
            cell_at_largest_[bin] = cell;
        }
    }
    int operator()(float cosine) const {
        const int bin = std::clamp(static_cast<int>((cosine + 1.0F) * kBinsPerUnit), 0, kBins - 1);
        const int cell = cell_at_largest_[bin];
        return std::min(kAngleCells - 1, cell + (cosine < smallest_cosine_[cell] ? 1 : 0));
    }

  private:
    static constexpr float kBinsPerUnit = 128.0F;
    static constexpr int kBins = 256;
    std::array<float, kAngleCells> smallest_cosine_{};
    std::array<int, kBins> cell_at_largest_{};  // of a bin's largest cosine
};

int angle_cell(float cosine) {
    static const AngleCells kCells;
    return kCells(cosine);
}

}  // namespace

PointPairTable::PointPairTable(const ViewGenerator& views)
    : points_(sample_surface(views)),
      surface_(views),
      diameter_m_(views.extent().diameter_m()),
      cells_(static_cast<std::size_t>(kDistanceCells) * kAngleCells * kAngleCells * kAngleCells) {
    const int count = static_cast<int>(points_.size());
    const int every = std::max(1, count / kMaxPairAnchors);
    for (int i = 0; i < count; i += every) {
        for (int j = 0; j < count; j += every) {
            const int cell = i == j ? -1 : cell_of(points_[i], points_[j]);
            if (cell >= 0) cells_[cell].push_back({i, j});
        }
    }
    largest_face_m2_ = largest_face(points_, 0.02 * diameter_m_);
}

int PointPairTable::cell_of(const OrientedPoint& first, const OrientedPoint& second) const {
    const Eigen::Vector3f line = second.point - first.point;
    const double distance = line.norm();
    const double place = (distance / diameter_m_ - kMinDistance) / (kMaxDistance - kMinDistance);
    if (!(place >= 0.0 && place < 1.0)) return -1;
    const Eigen::Vector3f direction = line / static_cast<float>(distance);
    const int angles =
        (angle_cell(first.normal.dot(direction)) * kAngleCells + angle_cell(second.normal.dot(direction))) *
            kAngleCells +
        angle_cell(first.normal.dot(second.normal));
    return static_cast<int>(place * kDistanceCells) * kAngleCells * kAngleCells * kAngleCells + angles;
}

const std::vector<PointPairTable::Pair>& PointPairTable::matches(const OrientedPoint& first,
                                                                 const OrientedPoint& second) const {
    static const std::vector<Pair> kNone;
    const int cell = cell_of(first, second);
    return cell < 0 ? kNone : cells_[cell];
}

}  // namespace nearpose
