// SPDX-License-Identifier: Apache-2.0
// Includes every header of the room `mechanics`: statics and kinematics of an object on two palms
// at one instant.
#pragma once

#include "palmbots/mechanics/acting_object.hpp"
#include "palmbots/mechanics/clearance.hpp"
#include "palmbots/mechanics/contact_detection.hpp"
#include "palmbots/mechanics/contact_modes.hpp"
#include "palmbots/mechanics/contact_modes_batch.hpp"
#include "palmbots/mechanics/drop_reason.hpp"
#include "palmbots/mechanics/equilibrium.hpp"
#include "palmbots/mechanics/feature_contact.hpp"
#include "palmbots/mechanics/friction_cone.hpp"
#include "palmbots/mechanics/loop_closure.hpp"
#include "palmbots/mechanics/model.hpp"
#include "palmbots/mechanics/rounded_body.hpp"
#include "palmbots/mechanics/sliding.hpp"
#include "palmbots/mechanics/slip_rule.hpp"
#include "palmbots/mechanics/surface.hpp"
#include "palmbots/mechanics/twist_feasibility.hpp"
#include "palmbots/mechanics/wrench_cone.hpp"
