#include "openclose/contact/kinematics.h"

namespace openclose {

ContactKinematics::ContactKinematics(const BlockSystem& system, const Contact& contact, const Unknowns& d_vertex, const Unknowns& d_edge)
    : ContactKinematics(ContactPose(ContactStart(system, contact),
                                    BlockMove(d_vertex, system.rotation_kind(), system.block(contact.vertex_block).radius),
                                    BlockMove(d_edge, system.rotation_kind(), system.block(contact.edge_block).radius))) {}

ContactKinematics::ContactKinematics(const ContactPose& pose)
    : normal(pose.normal),
      tangent(pose.tangent()),
      vertex_arm(pose.vertex_arm),
      edge_arm(pose.edge_arm),
      gap_change(pose.gap_change),
      slip_change(pose.slip_change),
      normal_vertex(Motion::gradient(vertex_arm, normal)),
      normal_edge(-Motion::gradient(edge_arm, normal)),
      shear_vertex(Motion::gradient(vertex_arm, tangent)),
      shear_edge(-Motion::gradient(edge_arm, tangent)) {}

}  // namespace openclose
