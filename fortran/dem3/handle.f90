!> A model of solids behind a handle: built in steps, run under as many motions as wanted, read after.
!> Every run starts from a copy of what was built, so runs of one model do not know of each other.
module dem3_handle
   use common_handles, only : handle_new, handle_take
   use common_kinds, only : wp
   use common_lists, only : handle_dem3
   use common_signal, only : signal
   use common_status, only : status_ok, status_not_ready, status_out_of_memory
   use common_threads, only : threads_available
   use dem3_bodies, only : body_set
   use dem3_law, only : joint_law
   use dem3_model, only : solid_model
   use dem3_run, only : run_begin, run_on, run_options, run_record, run_record_new
   use dem3_state, only : state_load
   use, intrinsic :: iso_c_binding, only : c_f_pointer, c_funloc, c_int, c_int64_t, c_loc, c_null_ptr, c_ptr
   implicit none
   private
   public :: built_solids, built_solids_register, built_solids_destroy, built_solids_take, run_solids, go_on_solids, &
      resume_solids

   type :: built_solids
      type(body_set) :: set
      type(joint_law), allocatable :: law(:)          !! the first is that of contacts that form later
      integer, allocatable :: law_of(:, :)            !! (3, joints): bodies, the lower first, and law
      real(wp), allocatable :: rate(:, :)             !! (6, bodies) velocity and spin at the start
      real(wp) :: gravity(3) = 0.0_wp                 !! [m/s^2]
      real(wp) :: way(3) = [1.0_wp, 0.0_wp, 0.0_wp]   !! of the horizontal ground motion
      type(run_options) :: options
      logical :: ready = .false.                      !! options have been set
      type(solid_model), allocatable :: model         !! as the last run left it
      type(run_record), allocatable :: record         !! of the last run
   end type built_solids

contains

   !> Hand a model over to the registry
   subroutine built_solids_register(built, handle, status)
      type(built_solids), pointer, intent(inout) :: built   !! null after a failure
      integer(c_int64_t), intent(out) :: handle
      integer(c_int), intent(out) :: status
      call handle_new(handle_dem3, c_loc(built), c_funloc(built_solids_destroy), handle, status)
      if (status /= status_ok) deallocate (built)
   end subroutine built_solids_register

   !> Called by the registry
   subroutine built_solids_destroy(object) bind(c, name='extrados_dem3_destroy')
      type(c_ptr), value, intent(in) :: object
      type(built_solids), pointer :: built
      call c_f_pointer(object, built)
      deallocate (built)
   end subroutine built_solids_destroy

   !> The model of a handle, for this call alone, until handle_leave; null where the status is not ok
   subroutine built_solids_take(handle, built, status)
      integer(c_int64_t), intent(in) :: handle
      type(built_solids), pointer, intent(out) :: built
      integer(c_int), intent(out) :: status
      type(c_ptr) :: object
      built => null()
      object = c_null_ptr
      call handle_take(handle, handle_dem3, .true., object, status)
      if (status == status_ok) call c_f_pointer(object, built)
   end subroutine built_solids_take

   !> Run from the start under a ground motion; `steps` 0 to the end, else about so many before it pauses
   subroutine run_solids(built, ground, wanted, steps, status)
      type(built_solids), intent(inout) :: built
      type(signal), intent(in) :: ground              !! acceleration [m/s^2]
      real(wp), intent(in) :: wanted(:)               !! output times [s]
      integer, intent(in) :: steps
      integer(c_int), intent(out) :: status
      type(run_options) :: options
      type(signal) :: silence
      integer :: k, axis

      call new_run(built, wanted, status)
      if (status /= status_ok) return
      associate (model => built%model)
         if (allocated(built%rate)) then
            do k = 1, size(model%set%item)
               associate (b => model%set%item(k))
                  if (b%fixed) cycle
                  b%v = built%rate(1:3, k)
                  b%swing = 0.0_wp
                  do axis = 1, 3
                     b%swing = b%swing &
                        + b%inertia(axis) * dot_product(b%turn(:, axis), built%rate(4:6, k)) * b%turn(:, axis)
                  end do
               end associate
            end do
         end if
      end associate
      built%model%load%ground = ground
      options = built%options
      options%threads = threads_available(options%threads)
      call run_begin(built%model, options, built%record, status)
      built%model%load%ground = silence               ! it pointed into the caller's set
      if (status == status_ok .and. built%record%paused) call go_on_solids(built, ground, steps, status)
   end subroutine run_solids

   !> On with a paused run, under the same motion
   subroutine go_on_solids(built, ground, steps, status)
      type(built_solids), intent(inout) :: built
      type(signal), intent(in) :: ground
      integer, intent(in) :: steps                    !! 0: to the end
      integer(c_int), intent(out) :: status
      type(run_options) :: options
      type(signal) :: silence
      status = status_not_ready
      if (.not. allocated(built%record)) return
      if (.not. built%record%paused) return
      built%model%load%ground = ground
      options = built%options
      options%threads = threads_available(options%threads)
      call run_on(built%model, options, steps, built%record, status)
      built%model%load%ground = silence
   end subroutine go_on_solids

   !> Take back the state of a run that had paused; see dem3_state
   subroutine resume_solids(built, wanted, word, status)
      type(built_solids), intent(inout) :: built
      real(wp), intent(in) :: wanted(:)               !! output times [s]
      integer(c_int64_t), intent(in) :: word(:)
      integer(c_int), intent(out) :: status
      call new_run(built, wanted, status)
      if (status /= status_ok) return
      call state_load(word, built%model, built%record, status)
      if (status /= status_ok) deallocate (built%model, built%record)
   end subroutine resume_solids

   !> A model and a record that have not run yet
   subroutine new_run(built, wanted, status)
      type(built_solids), intent(inout) :: built
      real(wp), intent(in) :: wanted(:)               !! output times [s]
      integer(c_int), intent(out) :: status
      integer :: failed
      status = status_not_ready
      if (.not. (allocated(built%law) .and. built%ready)) return
      if (allocated(built%model)) deallocate (built%model)
      if (allocated(built%record)) deallocate (built%record)
      allocate (built%model, built%record, stat=failed)
      status = merge(status_ok, status_out_of_memory, failed == 0)
      if (failed /= 0) return
      call run_record_new(size(built%set%item), wanted, built%record, status)
      if (status /= status_ok) then
         deallocate (built%model, built%record)
         return
      end if
      associate (model => built%model)
         model%set = built%set
         model%law = built%law
         if (allocated(built%law_of)) model%law_of = built%law_of
         model%gravity = built%gravity
         model%way = built%way
      end associate
   end subroutine new_run

end module dem3_handle
