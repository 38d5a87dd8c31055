!> Models of rigid bodies behind handles: built in steps, run under as many motions as wanted, read after.
!>
!> What was built stays as it is: every run starts from a copy, so runs of one model do not affect each other. Blocks
!> of the plane (dem_plane_handle) and of space (dem3_handle) copy them.
module dem_handle
   use common_handles, only : handle_new, handle_leave, handle_take
   use common_kinds, only : wp
   use common_lists, only : handle_dem
   use common_signal, only : signal
   use common_status, only : status_ok, status_bad_index, status_invalid_argument, status_not_ready, &
      status_out_of_memory
   use common_threads, only : threads_available
   use dem_joint, only : joint_law
   use dem_jointed, only : jointed_model
   use dem_places, only : place_table
   use dem_rigid, only : rigid_setting
   use dem_run, only : run_begin, run_on
   use dem_simulation, only : run_options, simulation
   use dem_state, only : state_load
   use dem_ties, only : tie_set, tie_set_copy
   use, intrinsic :: iso_c_binding, only : c_f_pointer, c_funloc, c_int, c_int64_t, c_loc, c_null_ptr, c_ptr
   implicit none
   private
   public :: built_model, model_register, model_destroy, model_take, run_take, paused_run_take, set_laws, set_options, &
      count_ties
   public :: new_run, resume_run, run_built

   type, abstract :: built_model
      type(run_options) :: options
      type(rigid_setting) :: rigid                 !! contacts without springs
      type(tie_set) :: ties
      type(place_table) :: places                  !! contacts whose forces are recorded with their places
      type(joint_law), allocatable :: law(:)       !! the first is that of contacts that form later
      integer :: highest_law = 0                   !! that a joint has
      logical :: ready = .false.                   !! the options were given
      class(simulation), allocatable :: run        !! the last one, as it was left
   contains
      procedure(copy_built), deferred :: new_run
   end type built_model

   abstract interface
      !> Allocate a run of a copy of what was built, at rest before its first step
      subroutine copy_built(built, wanted, status)
         import :: built_model, wp, c_int
         implicit none
         class(built_model), intent(inout) :: built
         real(wp), intent(in) :: wanted(:)         !! output times [s]
         integer(c_int), intent(out) :: status     !! not_ready where something was not built yet
      end subroutine copy_built
   end interface

   !> What the registry holds
   type :: model_box
      class(built_model), pointer :: built => null()
   end type model_box

contains

   !> Hand a model over to the registry
   subroutine model_register(built, handle, status)
      class(built_model), pointer, intent(inout) :: built   !! null after a failure
      integer(c_int64_t), intent(out) :: handle
      integer(c_int), intent(out) :: status
      type(model_box), pointer :: box
      integer :: failed
      handle = 0
      status = status_out_of_memory
      allocate (box, stat=failed)
      if (failed == 0) then
         box%built => built
         call handle_new(handle_dem, c_loc(box), c_funloc(model_destroy), handle, status)
         if (status /= status_ok) deallocate (box)
      end if
      if (status /= status_ok) deallocate (built)
   end subroutine model_register

   !> Called by the registry
   subroutine model_destroy(object) bind(c, name='extrados_dem_destroy')
      type(c_ptr), value, intent(in) :: object
      type(model_box), pointer :: box
      call c_f_pointer(object, box)
      deallocate (box%built)
      deallocate (box)
   end subroutine model_destroy

   !> The model of a handle, for this call alone, until handle_leave; null where the status is not ok
   subroutine model_take(handle, built, status)
      integer(c_int64_t), intent(in) :: handle
      class(built_model), pointer, intent(out) :: built
      integer(c_int), intent(out) :: status
      type(model_box), pointer :: box
      type(c_ptr) :: object
      built => null()
      object = c_null_ptr
      call handle_take(handle, handle_dem, .true., object, status)
      if (status /= status_ok) return
      call c_f_pointer(object, box)
      built => box%built
   end subroutine model_take

   !> The last run of a model, until handle_leave; null where the status is not ok
   subroutine run_take(handle, run, status)
      integer(c_int64_t), intent(in) :: handle
      class(simulation), pointer, intent(out) :: run
      integer(c_int), intent(out) :: status         !! not_ready where it has not run
      class(built_model), pointer :: built
      run => null()
      call model_take(handle, built, status)
      if (status /= status_ok) return
      if (allocated(built%run)) then
         run => last_run(built)
      else
         status = status_not_ready
         call handle_leave(handle)
      end if
   end subroutine run_take

   function last_run(built) result(run)
      class(built_model), intent(in), target :: built
      class(simulation), pointer :: run
      run => built%run
   end function last_run

   !> The same where that run has paused
   subroutine paused_run_take(handle, run, status)
      integer(c_int64_t), intent(in) :: handle
      class(simulation), pointer, intent(out) :: run
      integer(c_int), intent(out) :: status         !! not_ready where it cannot go on
      call run_take(handle, run, status)
      if (status /= status_ok) return
      if (run%record%paused) return
      run => null()
      status = status_not_ready
      call handle_leave(handle)
   end subroutine paused_run_take

   !> Types of joints
   subroutine set_laws(built, law, status)
      class(built_model), intent(inout) :: built
      type(joint_law), intent(in) :: law(:)
      integer(c_int), intent(out) :: status
      type(joint_law), allocatable :: copy(:)
      integer :: failed
      status = status_invalid_argument
      if (size(law) < max(1, built%highest_law)) return
      if (.not. all(law%normal_stiffness > 0.0_wp .and. law%shear_stiffness > 0.0_wp)) return
      if (.not. all(min(law%friction, law%cohesion, law%tension, law%damping, law%strength) >= 0.0_wp)) return
      status = status_out_of_memory
      allocate (copy(size(law)), stat=failed)
      if (failed /= 0) return
      copy(:) = law
      call move_alloc(copy, built%law)
      status = status_ok
   end subroutine set_laws

   !> Number of ties
   pure function count_ties(built) result(ties)
      class(built_model), intent(in) :: built
      integer :: ties
      ties = 0
      if (allocated(built%ties%item)) ties = size(built%ties%item)
   end function count_ties

   !> How to run
   subroutine set_options(built, options, status)
      class(built_model), intent(inout) :: built
      type(run_options), intent(in) :: options
      integer(c_int), intent(out) :: status
      status = status_invalid_argument
      if (.not. (options%end_time > 0.0_wp .and. options%fraction > 0.0_wp .and. options%fraction <= 1.0_wp)) return
      if (.not. min(options%step, options%settle_tolerance, options%settlement, options%collapse, &
                    options%residual_limit, options%settle_damping, options%collapse_turn, &
                    options%collapse_drop) >= 0.0_wp) return
      if (options%threads < 1) return
      built%options = options
      built%ready = .true.
      status = status_ok
   end subroutine set_options

   !> Begin a run that was made new, or go on with one that has paused, under the same motion: to its end or until it
   !> pauses. A cancelled run leaves what it has
   subroutine run_built(built, ground, across, steps, paused, time, status)
      class(built_model), intent(inout) :: built
      type(signal), intent(in) :: ground            !! acceleration [m/s^2]
      type(signal), intent(in) :: across            !! its other horizontal component; no segments: none
      integer, intent(in) :: steps                  !! after which it pauses; 0: it does not
      logical, intent(out) :: paused                !! it can go on
      real(wp), intent(out) :: time                 !! that it has come to [s]
      integer(c_int), intent(out) :: status
      paused = .false.
      time = 0.0_wp
      status = status_not_ready
      if (.not. allocated(built%run)) return
      if (built%run%record%begun .and. .not. built%run%record%paused) return
      call move_ground(built, ground, across)
      status = status_ok
      if (.not. built%run%record%begun) call run_begin(built%run, status)
      if (status == status_ok .and. built%run%record%paused) call run_on(built%run, steps, status)
      call rest_ground(built)
      paused = built%run%record%paused
      time = built%run%record%stop_time
   end subroutine run_built

   !> The ground's motion for this call, and threads as the machine has them now
   subroutine move_ground(built, ground, across)
      class(built_model), intent(inout), target :: built
      type(signal), intent(in) :: ground
      type(signal), intent(in) :: across            !! its other horizontal component; no segments: none
      class(jointed_model), pointer :: model
      model => built%run%get_model()
      model%load%ground = ground
      model%load%across = across
      built%run%options%threads = threads_available(built%options%threads)
   end subroutine move_ground

   !> The motion pointed into the caller's set
   subroutine rest_ground(built)
      class(built_model), intent(inout), target :: built
      class(jointed_model), pointer :: model
      type(signal) :: silence
      model => built%run%get_model()
      model%load%ground = silence
      model%load%across = silence
   end subroutine rest_ground

   !> Take back the state of a run that had paused; see dem_state
   subroutine resume_run(built, wanted, word, status)
      class(built_model), intent(inout) :: built
      real(wp), intent(in) :: wanted(:)             !! output times [s]
      integer(c_int64_t), intent(in) :: word(:)
      integer(c_int), intent(out) :: status
      call new_run(built, wanted, status)
      if (status /= status_ok) return
      call state_load(word, built%run, status)
      if (status /= status_ok) deallocate (built%run)
   end subroutine resume_run

   !> The ties of what was built, into the run that was made of it
   subroutine put_ties(built, status)
      class(built_model), intent(inout), target :: built
      integer(c_int), intent(out) :: status
      class(jointed_model), pointer :: model
      model => built%run%get_model()
      call tie_set_copy(built%ties, model%ties, status)
      if (any(model%ties%anchor%body > size(built%run%record%place, 2))) status = status_bad_index
      if (status /= status_ok) deallocate (built%run)
   end subroutine put_ties

   !> A run that has not begun, instead of the last one
   subroutine new_run(built, wanted, status)
      class(built_model), intent(inout) :: built
      real(wp), intent(in) :: wanted(:)             !! output times [s]
      integer(c_int), intent(out) :: status
      status = status_not_ready
      if (.not. built%ready) return
      if (allocated(built%run)) deallocate (built%run)
      call built%new_run(wanted, status)
      if (status == status_ok) call put_ties(built, status)
      if (status == status_ok) built%run%options = built%options
   end subroutine new_run

end module dem_handle
