!> A run of a model of rigid bodies: its options, its results, and the hooks that blocks of the plane
!> (dem_plane_run) and of space (dem3_run) fill. Their steps, on springs or on rigid contacts, are chosen here.
module dem_simulation
   use common_kinds, only : wp
   use common_lists, only : dem_energy_count, stop_end => dem_stop_end
   use common_status, only : status_ok, status_out_of_memory
   use common_threads, only : choose_threads, learn_pace, thread_pace
   use dem_energy, only : energy_terms
   use dem_jointed, only : jointed_model
   use dem_places, only : press_rows
   use dem_rigid, only : suitable_step, wait_for_rest
   use dem_tape, only : tape
   use, intrinsic :: iso_c_binding, only : c_int, c_int64_t
   implicit none
   private
   public :: run_options, run_record, run_record_new, simulation, any_step, model_sizes, slides_not

   !> Greatest stable step where any step is stable [s]
   real(wp), parameter :: any_step = huge(1.0_wp)
   integer, parameter :: model_sizes = 8     !! of a model in a stored state

   type :: run_options
      real(wp) :: end_time = 0.0_wp          !! [s]
      real(wp) :: step = 0.0_wp              !! [s]; 0: the fraction of the critical step
      real(wp) :: fraction = 0.3_wp          !! of the critical step
      real(wp) :: settle_tolerance = 1.0e-6_wp  !! unbalanced force over weight
      real(wp) :: settlement = 0.0_wp        !! displacement beyond which a body collapses instead of settling [m]; 0: none
      real(wp) :: collapse = 0.0_wp          !! displacement that counts as collapse [m]; 0: none
      real(wp) :: residual_limit = 0.1_wp    !! of the total energy exchanged
      real(wp) :: settle_damping = 0.0_wp    !! beta of all joints while they settle, where their own is less [s]
      real(wp) :: collapse_turn = 0.0_wp     !! a body that moved that far has collapsed if it rotated by more [rad]
      real(wp) :: collapse_drop = 0.0_wp     !! or is lower by more [m]; both 0: the displacement alone counts
      integer :: settle_steps = 0            !! at most; 0: no settling
      logical :: stop_at_rest = .false.      !! once the ground is quiet
      !> Of kinetic energy, and of that of the places over those at rest: below it the blocks recover, and a run that stops at rest ends
      !> once the ground is quiet [J]; 0: not used
      real(wp) :: safe = 0.0_wp
      real(wp) :: above = 0.0_wp             !! energy of the places at the start over those at rest [J]
      integer :: threads = 1
   end type run_options

   !> What a run leaves. The reason is one of the list dem_stop
   type :: run_record
      real(wp), allocatable :: wanted(:)        !! (nt) output times [s]
      real(wp), allocatable :: time(:)          !! (nt) times of the nearest steps [s]
      real(wp), allocatable :: place(:, :, :)   !! (3, bodies, nt) plane: x, y [m], rotation [rad]; space: centroids [m]
      real(wp), allocatable :: turn(:, :, :, :) !! (3, 3, bodies, nt) columns: the bodies' own axes; plane: of no body
      real(wp), allocatable :: rate(:, :, :)    !! (3 or 6, bodies, nt) velocity, spin; relative to the ground
      real(wp), allocatable :: energy(:, :)     !! (dem_energy_count, nt) [J]
      real(wp), allocatable :: tension(:, :)    !! (ties, nt) [N]
      !> (5, joints, nt) force on the first body of each joint [N], losses by friction and in dashpots so far [J]
      real(wp), allocatable :: joint(:, :, :)
      real(wp), allocatable :: press(:, :, :)   !! (press_rows, contacts, nt) see dem_places
      integer :: points = 0
      integer(c_int) :: reason = stop_end
      integer :: blamed(2) = 0               !! bodies that caused the stop, 0 none
      integer :: settling = 0                !! steps it took
      integer :: searches = 0
      integer :: pairs = 0                   !! that are near
      integer :: most_pairs = 0              !! after a search on the way
      real(wp) :: least_step = 0.0_wp        !! [s]
      real(wp) :: critical = 0.0_wp          !! critical step at the start; 0 where any step is stable [s]
      real(wp) :: stop_time = 0.0_wp         !! [s]
      real(wp) :: residual = 0.0_wp          !! greatest, over the total energy exchanged
      type(energy_terms) :: start            !! energies as the shaking began
      real(wp) :: round = 0.0_wp             !! greatest total energy exchanged so far [J]
      real(wp) :: taken = 0.0_wp             !! greatest lasting loss by rigid contacts so far [J]
      real(wp) :: damping = 0.0_wp           !! loss at the look before [J]
      integer :: calm_looks = 0              !! looks in a row at which all was quiet
      logical :: begun = .false.
      logical :: paused = .false.            !! it has not come to its end and can go on
   end type run_record

   !> A model on its way. Bodies are counted from 1
   type, abstract :: simulation
      type(run_options) :: options
      type(run_record) :: record
      type(thread_pace) :: pace
   contains
      procedure(model_of), deferred :: get_model         !! clock, laws of joints and rigid contacts
      procedure(search_pairs), deferred :: find_pairs    !! who is near whom
      procedure(critical), deferred :: find_critical_step  !! greatest stable step on springs and ties
      procedure(steps_on_springs), deferred :: advance_springs  !! up to so many, fewer where pairs change
      procedure(may_fail), deferred :: number_unknowns   !! of rigid contacts, after a search
      procedure(may_fail), deferred :: solve_contacts    !! forces of rigid contacts, added to the bodies
      procedure(change), deferred :: move_bodies         !! by these forces; time goes on
      procedure(tell_energy), deferred :: measure_energy  !! at the time of the last forces
      procedure(tell_number), deferred :: measure_agitation  !! what moves while it settles, like a kinetic energy [J]
      procedure(tell_number), deferred :: measure_speed  !! greatest of any body [m/s]
      procedure(tell_number), deferred :: measure_unbalance  !! greatest unbalanced force over weight, or moment
      procedure(tell_body), deferred :: find_least_balanced  !! the mobile body farthest from balance
      procedure(tell_body), deferred :: find_fastest     !! the mobile body of the greatest velocity
      procedure(look), deferred :: check_limits          !! has a body collapsed or left the scene?
      procedure(change), deferred :: mark_rest           !! places are counted from here
      procedure(change), deferred :: stop_bodies         !! no body moves
      procedure(change), deferred :: forget_settling     !! no dashpot force, loss or count is left from it
      procedure(change), deferred :: record_state        !! places and rates at the last forces, as the last point
      procedure(lengths), deferred :: list_sizes         !! what a state has in common with the model; its lengths
      procedure(allocate_like), deferred :: allocate_state  !! for a state of such lengths
      procedure(walk_through), deferred :: walk_state    !! everything of the model that changes, always in this order
      procedure :: find_stable_step
      procedure :: take_steps
   end type simulation

   abstract interface
      function model_of(run) result(model)
         import :: simulation, jointed_model
         implicit none
         class(simulation), intent(inout), target :: run
         class(jointed_model), pointer :: model
      end function model_of

      subroutine search_pairs(run, first_time, status)
         import :: simulation, c_int
         implicit none
         class(simulation), intent(inout) :: run        !! its record has their number
         logical, intent(in) :: first_time              !! then it refuses what was drawn wrong, by the record's reason
         integer(c_int), intent(out) :: status          !! not_finite where a place is no number
      end subroutine search_pairs

      subroutine critical(run, step, status)
         import :: simulation, wp, c_int
         implicit none
         class(simulation), intent(inout) :: run
         real(wp), intent(out) :: step                  !! [s]
         integer(c_int), intent(out) :: status
      end subroutine critical

      subroutine steps_on_springs(run, count, threads, status)
         import :: simulation, c_int
         implicit none
         class(simulation), intent(inout) :: run
         integer, intent(in) :: count
         integer, intent(in) :: threads
         integer(c_int), intent(out) :: status
      end subroutine steps_on_springs

      subroutine may_fail(run, status)
         import :: simulation, c_int
         implicit none
         class(simulation), intent(inout) :: run
         integer(c_int), intent(out) :: status
      end subroutine may_fail

      function tell_energy(run) result(now)
         import :: simulation, energy_terms
         implicit none
         class(simulation), intent(in) :: run
         type(energy_terms) :: now
      end function tell_energy

      function tell_number(run) result(number)
         import :: simulation, wp
         implicit none
         class(simulation), intent(in) :: run
         real(wp) :: number
      end function tell_number

      function tell_body(run) result(body)
         import :: simulation
         implicit none
         class(simulation), intent(in) :: run
         integer :: body
      end function tell_body

      subroutine look(run, collapse)
         import :: simulation, wp
         implicit none
         class(simulation), intent(inout) :: run        !! its record has the reason for the stop and the bodies that caused it
         real(wp), intent(in) :: collapse               !! displacement [m]; 0: none
      end subroutine look

      subroutine change(run)
         import :: simulation
         implicit none
         class(simulation), intent(inout) :: run
      end subroutine change

      function lengths(run) result(sizes)
         import :: simulation, model_sizes, c_int64_t
         implicit none
         class(simulation), intent(in) :: run
         integer(c_int64_t) :: sizes(model_sizes)
      end function lengths

      subroutine allocate_like(run, sizes, most, status)
         import :: simulation, model_sizes, c_int, c_int64_t
         implicit none
         class(simulation), intent(inout) :: run
         integer(c_int64_t), intent(in) :: sizes(model_sizes)
         integer(c_int64_t), intent(in) :: most         !! that a length can be
         integer(c_int), intent(out) :: status
      end subroutine allocate_like

      subroutine walk_through(run, on, status)
         import :: simulation, tape, c_int
         implicit none
         class(simulation), intent(inout), target :: run
         type(tape), intent(inout) :: on
         integer(c_int), intent(out) :: status
      end subroutine walk_through
   end interface

contains

   !> A record for `bodies` bodies at the times `wanted`
   subroutine run_record_new(bodies, rates, attitudes, ties, joints, contacts, wanted, record, status)
      integer, intent(in) :: bodies
      integer, intent(in) :: rates                   !! of a body
      logical, intent(in) :: attitudes               !! they are no part of its place
      integer, intent(in) :: ties
      integer, intent(in) :: joints                  !! whose forces are recorded
      integer, intent(in) :: contacts                !! the same with places
      real(wp), intent(in) :: wanted(:)              !! [s]
      type(run_record), intent(out) :: record
      integer(c_int), intent(out) :: status
      integer :: nt, failed
      nt = size(wanted)
      allocate (record%wanted(nt), record%time(nt), record%place(3, bodies, nt), record%rate(rates, bodies, nt), &
         record%turn(3, 3, merge(bodies, 0, attitudes), nt), record%energy(dem_energy_count, nt), &
         record%tension(ties, nt), record%joint(5, joints, nt), &
         record%press(press_rows, contacts, nt), stat=failed)
      status = merge(status_ok, status_out_of_memory, failed == 0)
      if (failed == 0) record%wanted(:) = wanted
   end subroutine run_record_new

   !> Whether a body that moved farther than counts as collapse did more than slide: it turned or is lower
   pure function slides_not(options, turned, dropped) result(gone)
      type(run_options), intent(in) :: options
      real(wp), intent(in) :: turned                 !! [rad]
      real(wp), intent(in) :: dropped                !! [m]
      logical :: gone
      gone = max(options%collapse_turn, options%collapse_drop) <= 0.0_wp
      if (.not. gone) gone = turned > options%collapse_turn .or. dropped > options%collapse_drop
   end function slides_not

   !> Greatest stable step, or any_step where neither contacts nor ties have springs, and the one to take where the
   !> options name none
   subroutine find_stable_step(run, stable, suitable, status)
      class(simulation), intent(inout), target :: run
      real(wp), intent(out) :: stable                !! [s]
      real(wp), intent(out) :: suitable              !! [s]
      integer(c_int), intent(out) :: status
      class(jointed_model), pointer :: model
      model => run%get_model()
      status = status_ok
      stable = any_step
      suitable = any_step
      if (.not. model%rigid%setting%used .or. size(model%ties%item) > 0) then
         call run%find_critical_step(stable, status)
         suitable = run%options%fraction * stable
      end if
      if (model%rigid%setting%used) suitable = min(suitable, suitable_step(model%rigid, model%quasi_static))
   end subroutine find_stable_step

   !> Up to so many steps, fewer where pairs must be searched again
   subroutine take_steps(run, count, status)
      class(simulation), intent(inout), target :: run
      integer, intent(in) :: count
      integer(c_int), intent(out) :: status
      class(jointed_model), pointer :: model
      model => run%get_model()
      if (model%rigid%setting%used) then
         call take_rigid_steps(run, model, count, status)
      else
         call take_spring_steps(run, model, count, status)
      end if
   end subroutine take_steps

   !> The same on springs, by as many threads as are fastest
   subroutine take_spring_steps(run, model, count, status)
      class(simulation), intent(inout) :: run
      class(jointed_model), pointer, intent(in) :: model     !! of the run
      integer, intent(in) :: count
      integer(c_int), intent(out) :: status
      integer :: first, before, threads, share
      status = status_ok
      first = model%steps
      do while (model%steps - first < count)
         before = model%steps
         call choose_threads(run%pace, run%options%threads, count - (before - first), threads, share)
         call run%advance_springs(share, threads, status)
         call learn_pace(run%pace, run%options%threads, model%steps - before)
         if (status /= status_ok .or. model%stale) return
      end do
   end subroutine take_spring_steps

   !> The same on contacts without springs, see dem_rigid
   subroutine take_rigid_steps(run, model, count, status)
      class(simulation), intent(inout) :: run
      class(jointed_model), pointer, intent(in) :: model     !! of the run
      integer, intent(in) :: count
      integer(c_int), intent(out) :: status
      integer :: n
      status = status_ok
      if (model%rigid%pairs /= run%record%pairs) call run%number_unknowns(status)
      do n = 1, count
         if (status == status_ok) call run%solve_contacts(status)
         if (status /= status_ok) return
         call run%move_bodies()
         if (model%quasi_static) call wait_for_rest(model%rigid, model%model_clock, run%measure_speed())
         if (model%stale) then
            model%rigid%pairs = -1
            return
         end if
      end do
   end subroutine take_rigid_steps

end module dem_simulation
