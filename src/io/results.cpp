#include "openclose/io/results.h"

#include <fmt/format.h>
#include <fmt/ostream.h>

#include <iterator>
#include <nlohmann/json.hpp>
#include <utility>

#include "openclose/core/check_sum.h"
#include "openclose/core/error.h"
#include "openclose/core/parallel.h"
#include "openclose/core/process.h"
#include "openclose/integrator/integrators.h"
#include "openclose/io/state_hash.h"
#include "openclose/io/text_files.h"
#include "openclose/scene/keys.h"
#include "openclose/scene/names.h"
#include "openclose/version.h"

namespace openclose {
namespace {

const char* name_of(ContactStatus status) {
  switch (status) {
    case ContactStatus::open:
      return "open";
    case ContactStatus::sticking:
      return "sticking";
    case ContactStatus::sliding:
      return "sliding";
  }
  return "";
}

/// In the column `stable`.
const char* word_of(TrialOutcome outcome) {
  switch (outcome) {
    case TrialOutcome::stable:
      return "1";
    case TrialOutcome::failed:
      return "0";
    case TrialOutcome::undecided:
      return "undecided";
  }
  return "";
}

/// Rows of a state are put together first: a table has hundreds of thousands of them. Numbers are the shortest that read back exactly, which is also
/// the quickest way to write them.
template <typename... Arguments>
void print(std::string& rows, fmt::format_string<Arguments...> format, Arguments&&... arguments) {
  fmt::format_to(std::back_inserter(rows), format, std::forward<Arguments>(arguments)...);
}

}  // namespace

std::vector<std::pair<const char*, double>> ledger_entries(const EnergyLedger& l) {
  return {{"kinetic_j", l.kinetic},
          {"gravity_j", l.gravity},
          {"base_motion_j", l.base_motion},
          {"contact_springs_j", l.contact_springs},
          {"support_springs_j", l.support_springs},
          {"loads_j", l.loads},
          {"friction_j", l.friction},
          {"contact_damping_j", l.contact_damping},
          {"mass_damping_j", l.mass_damping},
          {"impact_j", l.impact},
          {"scheme_j", l.scheme},
          {"redefinition_j", l.redefinition},
          {"turnover_j", l.turnover},
          {"imbalance_j", l.imbalance()}};
}

namespace {

std::string energy_columns() {
  std::string columns = "time_s";
  for (const auto& entry : ledger_entries({})) columns += fmt::format(",{}", entry.first);
  return columns;
}

}  // namespace

RunTable::RunTable(const OutputFolder& folder, const std::string& name, const std::string& columns, const RestartPoint* restart)
    : path_(folder.path_of(name)) {
  mark_ = {name, 0, empty_check_sum};
  if (restart) {
    for (const TableMark& mark : restart->checkpoint.tables) {
      if (mark.name != name) continue;
      file_ = folder.open_growing(name, table_beside(restart->checkpoint_file, name), mark.length);
      mark_ = mark;
    }
    return;
  }
  file_ = folder.open_growing(name);
  file_ << columns << '\n';
}

TableMark RunTable::written() {
  file_.flush();
  require_written();
  const auto length = static_cast<std::uint64_t>(file_.tellp());
  std::ifstream disk(path_, std::ios::binary);
  std::string added(static_cast<std::size_t>(length - mark_.length), ' ');
  if (!disk.seekg(static_cast<std::streamoff>(mark_.length)) || !disk.read(added.data(), static_cast<std::streamsize>(added.size())))
    throw WriteError(path_, "has been removed or cut while the run went on");
  mark_.sum = check_sum(added, mark_.sum);
  mark_.length = length;
  return mark_;
}

void RunTable::require_written() const {
  if (!file_) throw WriteError(path_);
}

HistoryFile::HistoryFile(const OutputFolder& folder, const RestartPoint* restart)
    : RunTable(folder, "history.csv",
               "time_s,point,displacement_x_m,displacement_y_m,rotation_rad,velocity_x_m_per_s,velocity_y_m_per_s,"
               "angular_velocity_rad_per_s",
               restart) {}

void HistoryFile::add(double time, const std::vector<PointMotion>& motions) {
  for (const PointMotion& m : motions) {
    fmt::print(file_, "{:.17g},{},{:.17g},{:.17g},{:.17g},{:.17g},{:.17g},{:.17g}\n", time, csv_field(m.name), m.displacement.x(), m.displacement.y(),
               m.rotation, m.velocity.x(), m.velocity.y(), m.angular_velocity);
  }
  require_written();
}

EnergyFile::EnergyFile(const OutputFolder& folder, const RestartPoint* restart) : RunTable(folder, "energy.csv", energy_columns(), restart) {}

void EnergyFile::add(double time, const EnergyLedger& ledger) {
  fmt::print(file_, "{:.17g}", time);
  for (const auto& entry : ledger_entries(ledger)) fmt::print(file_, ",{:.17g}", entry.second);
  file_ << '\n';
  require_written();
}

BlocksFile::BlocksFile(const OutputFolder& folder, const RestartPoint* restart)
    : RunTable(folder, "blocks.csv", "state,block,vertex,x_m,y_m", restart) {}

void BlocksFile::add(const std::string& state, const Scene& scene, const BlockSystem& system) {
  std::string rows;
  for (int b = 0; b < system.block_count(); ++b) {
    const auto& block = system.block(b);
    for (int i = 0; i < block.vertex_count; ++i) {
      const Vec2 p = system.position(b, block.first_vertex + i) + system.origin();
      print(rows, "{},{},{},{},{}\n", state, csv_field(scene.blocks[b].name), i, p.x(), p.y());
    }
  }
  file_ << rows;
  require_written();
}

ContactsFile::ContactsFile(const OutputFolder& folder, const RestartPoint* restart)
    : RunTable(folder, "contacts.csv", "state,block_a,block_b,x_m,y_m,normal_x,normal_y,length_m,gap_m,normal_force_n,shear_force_n,status",
               restart) {}

void ContactsFile::add(const std::string& state, const Scene& scene, const BlockSystem& system, const std::vector<Contact>& contacts) {
  const auto still = Motion::Unknowns::Zero().eval();
  std::string rows;
  for (const Contact& c : contacts) {
    const Vec2 p = system.position(c.vertex_block, c.vertex) + system.origin();
    const Vec2 n = ContactKinematics(system, c, still, still).normal;
    print(rows, "{},{},{},{},{},{},{},{},{},{},{},{}\n", state, csv_field(scene.blocks[c.vertex_block].name),
          csv_field(scene.blocks[c.edge_block].name), p.x(), p.y(), n.x(), n.y(), c.length, c.gap, c.normal_force, c.shear_force, name_of(c.status));
  }
  file_ << rows;
  require_written();
}

BlockStatesFile::BlockStatesFile(const OutputFolder& folder, const RestartPoint* restart)
    : RunTable(folder, "block_states.csv",
               "state,time_s,block,x_m,y_m,displacement_x_m,displacement_y_m,rotation_rad,velocity_x_m_per_s,velocity_y_m_per_s,"
               "angular_velocity_rad_per_s",
               restart) {}

void BlockStatesFile::add_place(std::string& rows, const std::string& state, const std::string& time, const Scene& scene, const BlockSystem& system,
                                int b) const {
  const Vec2 p = system.centroid(b) + system.origin();
  const auto& d = system.displacement(b);
  print(rows, "{},{},{},{},{},{},{},{}", state, time, csv_field(scene.blocks[b].name), p.x(), p.y(), d[0], d[1], Motion::rotation(d));
}

void BlockStatesFile::add(const std::string& state, const Simulation& simulation) {
  const std::string time = fmt::format("{}", simulation.time());
  std::string rows;
  for (int b = 0; b < simulation.system().block_count(); ++b) {
    add_place(rows, state, time, simulation.scene(), simulation.system(), b);
    const auto v = simulation.velocity(b);
    print(rows, ",{},{},{}\n", v[0], v[1], Motion::rotation(v));
  }
  file_ << rows;
  require_written();
}

void BlockStatesFile::add(const std::string& state, const Scene& scene, const BlockSystem& system) {
  std::string rows;
  for (int b = 0; b < system.block_count(); ++b) {
    add_place(rows, state, "", scene, system, b);
    print(rows, ",,,\n");
  }
  file_ << rows;
  require_written();
}

CracksFile::CracksFile(const OutputFolder& folder, const Scene& scene, const RestartPoint* restart)
    : RunTable(folder, "cracks.csv", "state,block_a,block_b,x1_m,y1_m,x2_m,y2_m,length_m,opening1_m,opening2_m,slip1_m,slip2_m,joint", restart),
      joints_(drawn_joints(scene)) {}

void CracksFile::add(const std::string& state, const Scene& scene, const BlockSystem& system, JointDirection direction) {
  std::string rows;
  for (const DrawnJoint& joint : joints_) {
    const JointMotion m = joint_motion(joint, system, direction);
    print(rows, "{},{},{},{},{},{},{},{},{},{},{},{},{}\n", state, csv_field(scene.blocks[joint.block_a].name),
          csv_field(scene.blocks[joint.block_b].name), m.from.middle.x(), m.from.middle.y(), m.to.middle.x(), m.to.middle.y(),
          (joint.to_b - joint.from_b).norm(), m.from.opening, m.to.opening, m.from.slip, m.to.slip, csv_field(name_of_joint(scene, joint)));
  }
  file_ << rows;
  require_written();
}

ContactHistoryFile::ContactHistoryFile(const OutputFolder& folder, const RestartPoint* restart)
    : RunTable(folder, "contact_history.csv", "time_s,contact,normal_force_n,shear_force_n,gap_m,slip_m,status,closed_contacts", restart) {}

void ContactHistoryFile::add(double time, const std::vector<ContactMotion>& motions) {
  for (const ContactMotion& m : motions) {
    fmt::print(file_, "{:.17g},{},{:.17g},{:.17g},{:.17g},{:.17g},{},{}\n", time, csv_field(m.name), m.normal_force, m.shear_force, m.gap, m.slip,
               name_of(m.status), m.closed);
  }
  require_written();
}

StateTables::StateTables(const OutputFolder& folder, const Scene& scene, const RestartPoint* restart)
    : blocks_(folder, restart), contacts_(folder, restart), states_(folder, restart), cracks_(folder, scene, restart) {}

void StateTables::add(const std::string& state, const Simulation& simulation) {
  blocks_.add(state, simulation);
  const ContactSet& contacts = simulation.state().contacts;
  for (const std::vector<Contact>* list : {&contacts.moving, &contacts.resting}) contacts_.add(state, simulation.scene(), simulation.system(), *list);
  states_.add(state, simulation);
  cracks_.add(state, simulation.scene(), simulation.system());
}

void StateTables::add(const NamedState& state, const Scene& scene) {
  blocks_.add(state.name, scene, state.system);
  contacts_.add(state.name, scene, state.system, state.contacts);
  states_.add(state.name, scene, state.system);
  cracks_.add(state.name, scene, state.system, state.is_mechanism ? JointDirection::drawn : JointDirection::moved);
}

std::vector<TableMark> StateTables::written() {
  return {blocks_.written(), contacts_.written(), states_.written(), cracks_.written()};
}

void StateTables::close() {
  blocks_.close();
  contacts_.close();
  states_.close();
  cracks_.close();
}

void write_block_properties(const OutputFolder& folder, const Scene& scene, const BlockSystem& system) {
  std::ofstream file = folder.open("block_properties.csv");
  file << "block,material,fixed,area_m2,mass_kg\n";
  for (int b = 0; b < system.block_count(); ++b) {
    const BlockInput& block = scene.blocks[b];
    fmt::print(file, "{},{},{},{:.17g},{:.17g}\n", csv_field(block.name), csv_field(scene.materials[block.material].name), block.fixed ? 1 : 0,
               system.block(b).area, system.block(b).mass[0]);
  }
  finish(file, folder.path_of("block_properties.csv"));
}

void write_mechanism(const OutputFolder& folder, const Scene& scene, const std::vector<FailingBlock>& blocks) {
  std::ofstream file = folder.open("mechanism.csv");
  file << "block,area_m2,x_m,y_m,velocity_x,velocity_y,rotation_per_m\n";
  for (const FailingBlock& b : blocks) {
    fmt::print(file, "{},{:.17g},{:.17g},{:.17g},{:.17g},{:.17g},{:.17g}\n", csv_field(scene.blocks[b.block].name), b.area, b.centroid.x(),
               b.centroid.y(), b.velocity.x(), b.velocity.y(), b.rotation);
  }
  finish(file, folder.path_of("mechanism.csv"));
}

void write_trials(const OutputFolder& folder, const std::vector<StrengthTrial>& trials, const char* factor) {
  std::ofstream file = folder.open("trials.csv");
  file << factor << ",stage,stable,criterion,steps,displacement_m\n";
  for (const StrengthTrial& t : trials) {
    fmt::print(file, "{:.17g},{},{},{},{},{:.17g}\n", t.srf, t.stage, word_of(t.outcome), csv_field(t.criterion), t.steps, t.displacement);
  }
  finish(file, folder.path_of("trials.csv"));
}

void write_curve(const OutputFolder& folder, const std::vector<CurvePoint>& curve) {
  std::ofstream file = folder.open("curve.csv");
  file << "srf,point,displacement_m\n";
  for (const CurvePoint& p : curve) fmt::print(file, "{:.17g},{},{:.17g}\n", p.srf, csv_field(p.point), p.displacement);
  finish(file, folder.path_of("curve.csv"));
}

void write_milestones(const OutputFolder& folder, const std::vector<Milestone>& milestones) {
  std::ofstream file = folder.open("milestones.csv");
  file << "displacement_m,time_s,cpu_s,cpu_of_program_s,reason\n";
  for (const Milestone& m : milestones) {
    if (m.time) {
      fmt::print(file, "{:.17g},{:.17g},{:.17g},{:.17g},\n", m.displacement, *m.time, m.cpu_of_motion, m.cpu_of_program);
    } else {
      fmt::print(file, "{:.17g},,,,{}\n", m.displacement, csv_field(m.reason));
    }
  }
  finish(file, folder.path_of("milestones.csv"));
}

}  // namespace openclose
