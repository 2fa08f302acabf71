#include "src/dataio/plain_layout.h"

#include <algorithm>
#include <limits>

namespace alidade::internal {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

bool IsPlain(const ReadHeader& header, const DataFormat& format) {
  const MeasuredGroups& groups = header.groups;
  return format.where.empty() && header.columns.target_positions.empty() &&
         (groups.position || groups.orientation()) && !groups.covariance &&
         !groups.distance && !groups.fixed_point && !groups.plane &&
         !groups.difference && !header.rows.Has(header.columns.angle_sigma);
}

// The slot of a quantity; -1 where plain data sets have none for it.
int SlotOf(int spec, const DatasetColumns& columns, const RowSlots& slots) {
  struct Group {
    int first;
    int count;
    int slot;
  };
  for (const Group& group :
       {Group{0, slots.position, 0}, Group{columns.position, 3, slots.position},
        Group{columns.position_sigma, 3, slots.position_sigma},
        Group{columns.quaternion, 4, slots.orientation},
        Group{columns.vector, 3, slots.orientation},
        Group{columns.angles, 3, slots.orientation},
        Group{columns.turn_sigma, 3, slots.turn_sigma}}) {
    const int offset = spec - group.first;
    if (offset >= 0 && offset < group.count) return group.slot + offset;
  }
  return -1;
}

// Nothing where the column is of use, but not to a plain data set.
std::optional<PlainColumn> MakeColumn(const RowReader::Column& column,
                                      const ReadHeader& header,
                                      const RowSlots& slots) {
  PlainColumn plain;
  if (column.spec < 0 || !header.rows.Has(column.spec)) return plain;
  const DatasetColumns& columns = header.columns;
  if (column.spec == columns.target) {
    plain.use = PlainColumn::Use::kTarget;
    return plain;
  }
  if (column.spec == columns.set) {
    plain.use = PlainColumn::Use::kSet;
    return plain;
  }
  plain.use = PlainColumn::Use::kNumber;
  plain.slot = SlotOf(column.spec, columns, slots);
  if (plain.slot < 0) return std::nullopt;
  if (column.unit != nullptr) plain.unit = *column.unit;
  plain.rule = columns.specs[column.spec].rule;
  return plain;
}

PlainOrientation OrientationOf(const MeasuredGroups& groups) {
  if (groups.quaternion) return PlainOrientation::kQuaternion;
  if (groups.vector) return PlainOrientation::kVector;
  return groups.angles ? PlainOrientation::kAngles : PlainOrientation::kNone;
}

// False where the format names a target that the arm does not have.
bool FindTargets(const Arm& arm, const DataFormat& format,
                 PlainLayout* layout) {
  for (const Target& target : arm.targets) {
    layout->target_names.push_back(target.name);
  }
  if (format.target.empty()) return true;
  const auto& names = layout->target_names;
  const auto found = std::find(names.begin(), names.end(), format.target);
  layout->target = static_cast<int>(found - names.begin());
  return found != names.end();
}

bool IsOfSigmas(const PlainColumn& column, const RowSlots& slots) {
  const auto is_in = [&](int first) {
    return column.slot >= first && column.slot < first + 3;
  };
  return column.use == PlainColumn::Use::kNumber &&
         (is_in(slots.position_sigma) || is_in(slots.turn_sigma));
}

}  // namespace

Eigen::VectorXd PlainLayout::DefaultSigmas() const {
  Eigen::VectorXd sigmas(RowsOf(kind()));
  for (Eigen::Index row = 0; row < sigmas.size(); ++row) {
    const Eigen::Index first =
        row < 3 ? slots.position_sigma : slots.turn_sigma - 3;
    sigmas[row] = defaults[static_cast<std::size_t>(first + row)];
  }
  return sigmas;
}

std::optional<PlainLayout> MakePlainLayout(const ReadHeader& header,
                                           const Arm& arm,
                                           const DataFormat& format,
                                           double rotation_sigma) {
  PlainLayout layout(arm.num_joints());
  if (!IsPlain(header, format) || !FindTargets(arm, format, &layout)) {
    return std::nullopt;
  }
  for (const RowReader::Column& column : header.rows.columns()) {
    const std::optional<PlainColumn> plain =
        MakeColumn(column, header, layout.slots);
    if (!plain) return std::nullopt;
    layout.columns.push_back(*plain);
  }
  layout.states_sigmas =
      std::any_of(layout.columns.begin(), layout.columns.end(),
                  [&](const PlainColumn& column) {
                    return IsOfSigmas(column, layout.slots);
                  });
  layout.orientation = OrientationOf(header.groups);
  layout.convention = format.rotation;
  layout.has_target = header.rows.Has(header.columns.target);
  layout.has_set = header.rows.Has(header.columns.set);
  const auto row = layout.defaults.begin();
  std::fill_n(row + layout.slots.position, 3, kNan);
  std::fill_n(row + layout.slots.position_sigma, 3, format.sigma);
  std::fill_n(row + layout.slots.turn_sigma, 3, rotation_sigma);
  return layout;
}

}  // namespace alidade::internal
