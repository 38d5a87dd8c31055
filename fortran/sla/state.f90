!> What the event loop of sequentially linear analysis keeps from event to event, part by part.
!>
!> Loads are A + lambda B, displacements ua + lambda ub: products of the loads with the displacements come in fours.
module sla_state
   use common_kinds, only : wp
   use sla_group, only : event_vectors, most_rank, point_event, point_place, scan_result, unbounded
   use sla_regions, only : region_tree
   use, intrinsic :: iso_c_binding, only : c_int, c_int64_t
   implicit none
   private
   public :: load_work, load_vectors, moved_supports, solution_vectors, limit_search, sliding_state, loop_state
   public :: energy_ledger, force_release, residual_checks, stop_rules, monitor_set, equilibrium_path, entry_places

   !> Products of two loads, constant (a) and per multiplier (b), with the displacements of both [J]
   type :: load_work
      real(wp) :: aa = 0.0_wp
      real(wp) :: ab = 0.0_wp
      real(wp) :: ba = 0.0_wp          !! equals ab unless joints slide
      real(wp) :: bb = 0.0_wp
   contains
      procedure, private :: minus
      generic :: operator(-) => minus
   end type load_work

   type :: load_vectors
      real(wp), allocatable :: fa(:), fb(:)              !! (0:n) constant and reference load [N]
      real(wp), allocatable :: fo(:)                     !! (0:n) forces of origins that moved, see sla_group [N]
      real(wp), allocatable :: fh(:, :)                  !! (0:n, 2) held forces, constant and per multiplier [N]
   end type load_vectors

   !> Supports whose displacements are prescribed, constant and per multiplier
   type :: moved_supports
      real(wp), allocatable :: moved(:, :)               !! (moved, 2) displacements [m]
      real(wp), allocatable :: reaction(:, :)            !! (moved, 2) forces [N]
      integer, allocatable :: beside(:, :)               !! (2, elements) group and element at a moved support
      type(load_work) :: work                            !! of both reactions on both columns of `moved`
   end type moved_supports

   type :: solution_vectors
      !> (0:n + moved) displacements where the tree brought them up to date, see model_displacements [m]
      real(wp), allocatable :: ua(:), ub(:)
      real(wp), allocatable :: z(:, :)                   !! (n, 2) right sides, then solutions
      real(wp), allocatable :: force(:)                  !! (0:n + moved) internal forces
      type(load_work) :: work                            !! of the loads and the reactions, the last damage applied
   end type solution_vectors

   !> Where the limits of the multiplier are looked for
   type :: limit_search
      type(region_tree) :: tree                          !! what an event matters to
      type(scan_result), allocatable :: part(:)          !! limits of each region
      integer, allocatable :: list(:)                    !! regions looked at in this event
      logical, allocatable :: wanted(:), watched(:)      !! regions to be brought in this event, in each event
      type(point_place) :: upper, lower                  !! points of the last limits
      real(wp) :: noise = 0.0_wp                         !! stress under B that counts as none [Pa]
   end type limit_search

   !> Joints that slide: what the next state is compared with
   type :: sliding_state
      logical :: active = .false.                        !! a point has slipped: no region may wait
      real(wp), allocatable :: u_before(:)               !! displacements of the last state [m]
      real(wp), allocatable :: f_before(:)               !! held forces of the last state [N]
      real(wp) :: held(2) = 0.0_wp                       !! fh.u of the last state [J]
      real(wp) :: excess = 0.0_wp                        !! energy that the held forces take back there [J]
      real(wp) :: elastic = 0.0_wp                       !! of the slip in the last state, see friction_group [J]
      real(wp) :: origin_energy = 0.0_wp                 !! [J]
   end type sliding_state

   !> Where the event loop stands in its stage
   type :: loop_state
      type(point_event) :: pending                       !! chosen, not yet applied; group 0: none
      type(event_vectors) :: event                       !! change of the stiffness by the last event
      real(wp) :: before(most_rank) = 0.0_wp             !! w.u before the last event
      integer :: events = 0
      real(wp) :: lambda = 0.0_wp
      real(wp) :: lambda_held = 0.0_wp                   !! of the last state in equilibrium
      real(wp) :: scale = 1.0_wp                         !! of all loads, A too, in the state chosen; see stop_rules
      real(wp) :: first_compliance = 0.0_wp              !! fb.ub at the start of the stage
      real(wp) :: first_constant = 0.0_wp                !! work of the constant loads and supports there [J]
      real(wp) :: peak = 0.0_wp                          !! greatest |lambda| in equilibrium of the stage
      real(wp) :: peak_displacement = 0.0_wp             !! of monitor 1 there [m]
      real(wp) :: start_displacement = 0.0_wp            !! of monitor 1 under the constant loads at the start [m]
      real(wp) :: furthest = 0.0_wp                      !! its greatest way from there in the sense of the load [m]
      real(wp) :: fallen_from = unbounded                !! the way from which on the load is below a fraction [m]
      real(wp) :: slope = 0.0_wp                         !! of monitor 1 per unit lambda [m]
   end type loop_state

   !> Energies up to the last state, and that state
   type :: energy_ledger
      real(wp) :: external = 0.0_wp                      !! [J]
      real(wp) :: dissipated = 0.0_wp                    !! along the straight way between events [J]
      real(wp) :: cracked = 0.0_wp                       !! at constant strain: the area of the teeth, never falls [J]
      type(load_work) :: work                            !! in the last state
      type(load_work) :: support_work                    !! the part of the reactions
      real(wp) :: lambda = 0.0_wp
      real(wp) :: scale = 1.0_wp
      logical :: recorded = .false.                      !! the stage has a state to count energy from
      logical :: carried = .false.                       !! the work of the constant loads is counted already
   end type energy_ledger

   !> The forces of the last tooth are set free along a straight way, see sla_release
   type :: force_release
      logical :: active = .false.
      real(wp), allocatable :: from(:)                   !! (0:n + moved) displacements where the way begins [m]
      real(wp) :: part = 0.0_wp                          !! of the way in the state chosen
      real(wp) :: stored = 0.0_wp                        !! energy there [J]
      real(wp) :: force = 0.0_wp                         !! that moves supports there [N]
   end type force_release

   !> Where the entries of a group's elements lie in the matrix
   type :: entry_places
      integer(c_int64_t), allocatable :: at(:, :)        !! (pairs of freedoms, elements of a group), 0 none
   end type entry_places

   !> The path that equilibrium iterations follow where events find no equilibrium, see sla_continuation
   type :: equilibrium_path
      type(entry_places), allocatable :: places(:)       !! (groups) of elements' entries in the matrix
      logical :: active = .false.
      logical :: implicit = .true.                       !! else implicit-explicit integration
      logical :: by_energy = .false.                     !! arc length on dissipated energy where the control snaps back
      logical :: on_arc = .false., snaps = .false.       !! the iteration is one of it; the last step was, and went back
      real(wp) :: energy_step = 0.0_wp                   !! dissipated energy of such a step [J]
      real(wp) :: most_stored = 0.0_wp                   !! in any state [J]
      real(wp), allocatable :: u(:)                      !! (0:n + moved) displacements of the iteration [m]
      real(wp), allocatable :: now(:), before(:)         !! (0:n + moved) of the last two states [m]
      real(wp), allocatable :: start(:)                  !! (0:n + moved) of the first state [m]
      real(wp) :: drive_start = 0.0_wp                   !! control there [J]
      real(wp), allocatable :: push(:)                   !! (0:n + moved) forces per multiplier of moved supports [N]
      !> (entries, 2) of the matrix, and of its transpose: what sliding friction adds, see sla_group (couple)
      real(wp), allocatable :: beside(:, :)
      logical :: coupled = .false.                       !! it adds something
      real(wp) :: lambda = 0.0_wp                        !! of the iteration
      real(wp) :: lambda_now = 0.0_wp, lambda_before = 0.0_wp
      real(wp) :: drive = 0.0_wp                         !! work-conjugate displacement of load B in the last state [J]
      real(wp) :: step = 0.0_wp, last_step = 0.0_wp      !! of `drive` [J]
      real(wp) :: longest = 0.0_wp                       !! step [J]
      real(wp) :: runaway = unbounded                    !! displacement that no state in equilibrium has [m]
      real(wp) :: least_runaway = 0.0_wp                 !! [m]
      real(wp) :: unit = 1.0_wp                          !! of `drive` per displacement [N]
      real(wp) :: constant = 0.0_wp                      !! fa.u in the last state [J]
      real(wp) :: force = 0.0_wp                         !! on what the multiplier moves, in the last state [N]
      real(wp) :: stored = 0.0_wp                        !! [J]
      real(wp) :: gap = 0.0_wp                           !! work less stored and dissipated energy in the last state [J]
      real(wp) :: released = 0.0_wp                      !! energy lost as motion in drops to another equilibrium [J]
      real(wp) :: residual = 0.0_wp                      !! over the largest nodal force
      integer :: solutions = 0                           !! linear systems solved
      integer :: steps = 0
   end type equilibrium_path

   !> See sla_guard
   type :: residual_checks
      real(wp) :: residual = 0.0_wp                      !! the last that was found, over the loads
      integer :: checks = 0
      integer :: solutions = 0                           !! repeated for a residual
      integer :: factors = 0                             !! made anew for a residual
   end type residual_checks

   !> Where a stage ends and how it goes on without equilibrium
   type :: stop_rules
      real(wp) :: lambda = unbounded               !! stage ends where it carries this multiplier
      real(wp) :: displacement = unbounded         !! of monitor 1, absolute [m]
      real(wp) :: fraction = -1.0_wp               !! of the peak multiplier, after it; negative: never
      real(wp) :: compliance = 1.0e6_wp            !! fb.ub over its first value: a mechanism
      logical :: refuse_overload = .false.         !! the first state must carry the constant loads
      !> Where no multiplier suits all points: all loads of the last state in equilibrium are scaled down together
      !> (intermittent proportional loading); else the constant loads stay and the greatest lower limit decides
      logical :: proportional = .false.
      !> The forces that a tooth sets free go onto the others at the load reached, before it grows again
      logical :: release = .false.
      real(wp) :: target = unbounded               !! of monitor 1 [m]: the stage ends in the state that has it
      real(wp) :: side = 0.0_wp                    !! +1: it is reached from below, -1: from above, 0: there is none
      real(wp) :: already = 0.0_wp                 !! loads like B that are on already, over B
      !> Where no multiplier suits all points, or the factor is lost, equilibrium iterations go on
      logical :: continues = .false.
      real(wp) :: far = unbounded                  !! way of monitor 1 beyond which displacements are not small [m]
   end type stop_rules

   !> Weighted sums of displacements that are recorded
   type :: monitor_set
      integer(c_int), allocatable :: first(:)            !! (monitors + 1) first entry of each monitor
      integer(c_int), allocatable :: equation(:)         !! (entries), factor order
      real(wp), allocatable :: share(:)                  !! (entries)
      real(wp), allocatable :: ratio(:)                  !! (monitors) to the work of B, 0: not of this kind [1/N]
   contains
      procedure :: sum_of
   end type monitor_set

contains

   pure function minus(a, b) result(difference)
      class(load_work), intent(in) :: a
      type(load_work), intent(in) :: b
      type(load_work) :: difference
      difference = load_work(a%aa - b%aa, a%ab - b%ab, a%ba - b%ba, a%bb - b%bb)
   end function minus

   !> Monitor k of some displacements
   pure function sum_of(monitors, k, u) result(total)
      class(monitor_set), intent(in) :: monitors
      integer, intent(in) :: k
      real(wp), intent(in) :: u(0:)        !! [m]
      real(wp) :: total
      integer :: i
      total = 0.0_wp
      do i = int(monitors%first(k)), int(monitors%first(k + 1)) - 1
         total = total + monitors%share(i) * u(monitors%equation(i))
      end do
   end function sum_of

end module sla_state
