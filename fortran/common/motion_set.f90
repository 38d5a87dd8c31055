!> Ground motions kept in the core behind one handle: each sampled, or piecewise analytic, with its own arrays.
module common_motion_set
   use common_handles, only : handle_new, handle_take
   use common_kinds, only : wp
   use common_lists, only : handle_motions
   use common_signal, only : signal, signal_sampled, signal_piecewise
   use common_status, only : status_ok, status_bad_index, status_invalid_argument, status_not_finite, &
      status_not_ready, status_out_of_memory
   use, intrinsic :: iso_c_binding, only : c_f_pointer, c_funloc, c_int, c_int64_t, c_loc, c_null_ptr, c_ptr
   implicit none
   private
   public :: motion_set, motion_set_new, motion_set_destroy, motion_set_take, set_samples, set_pieces, motion_signal

   !> Horizontal, and vertical where there is one
   integer, parameter :: most_channels = 2

   !> One motion: either samples or pieces are allocated; neither where it was not given yet
   type :: motion
      real(wp) :: start = 0.0_wp                          !! time of the first sample [s]
      real(wp) :: step = 0.0_wp                           !! [s]
      real(wp), allocatable :: samples(:, :)              !! (channels, points) [m/s^2]
      real(wp), allocatable :: breaks(:)                  !! (segments + 1) [s]
      real(wp), allocatable :: linear(:, :, :)            !! (2, channels, segments), see signal
      real(wp), allocatable :: harmonic(:, :, :, :)       !! (4, terms, channels, segments), see signal
   end type motion

   type :: motion_set
      type(motion), allocatable :: item(:)
   end type motion_set

contains

   !> Room for `count` motions
   subroutine motion_set_new(count, handle, status)
      integer(c_int), intent(in) :: count
      integer(c_int64_t), intent(out) :: handle
      integer(c_int), intent(out) :: status
      type(motion_set), pointer :: set
      integer :: failed
      handle = 0
      status = status_invalid_argument
      if (count < 1) return
      status = status_out_of_memory
      allocate (set, stat=failed)
      if (failed /= 0) return
      allocate (set%item(count), stat=failed)
      if (failed == 0) call handle_new(handle_motions, c_loc(set), c_funloc(motion_set_destroy), handle, status)
      if (status /= status_ok) deallocate (set)
   end subroutine motion_set_new

   !> Called by the registry
   subroutine motion_set_destroy(object) bind(c, name='extrados_motions_destroy')
      type(c_ptr), value, intent(in) :: object
      type(motion_set), pointer :: set
      call c_f_pointer(object, set)
      deallocate (set)
   end subroutine motion_set_destroy

   !> The set of a handle, until handle_leave; null where the status is not ok
   subroutine motion_set_take(handle, alone, set, status)
      integer(c_int64_t), intent(in) :: handle
      logical, intent(in) :: alone                   !! this call changes it
      type(motion_set), pointer, intent(out) :: set
      integer(c_int), intent(out) :: status
      type(c_ptr) :: object
      set => null()
      object = c_null_ptr
      call handle_take(handle, handle_motions, alone, object, status)
      if (status == status_ok) call c_f_pointer(object, set)
   end subroutine motion_set_take

   !> Motion `number` by samples joined by straight lines
   subroutine set_samples(set, number, start, step, samples, status)
      type(motion_set), intent(inout) :: set
      integer(c_int), intent(in) :: number           !! 1-based
      real(wp), intent(in) :: start                  !! [s]
      real(wp), intent(in) :: step                   !! [s]
      real(wp), intent(in) :: samples(:, :)          !! (channels, points) [m/s^2]
      integer(c_int), intent(out) :: status
      real(wp), allocatable :: copy(:, :)
      integer :: failed
      call check_place(set, number, size(samples, 1), status)
      if (status /= status_ok) return
      status = status_invalid_argument
      if (size(samples, 2) < 2 .or. .not. step > 0.0_wp) return
      status = status_not_finite
      if (.not. (abs(start) <= huge(start) .and. step <= huge(step) .and. all(abs(samples) <= huge(step)))) return
      status = status_out_of_memory
      allocate (copy(size(samples, 1), size(samples, 2)), stat=failed)
      if (failed /= 0) return
      copy(:, :) = samples
      set%item(number) = motion(start=start, step=step)
      call move_alloc(copy, set%item(number)%samples)
      status = status_ok
   end subroutine set_samples

   !> Motion `number` by straight lines and sines between breaks
   subroutine set_pieces(set, number, breaks, linear, harmonic, status)
      type(motion_set), intent(inout) :: set
      integer(c_int), intent(in) :: number           !! 1-based
      real(wp), intent(in) :: breaks(:)              !! (segments + 1), ascending [s]
      real(wp), intent(in) :: linear(:, :, :)        !! (2, channels, segments)
      real(wp), intent(in) :: harmonic(:, :, :, :)   !! (4, terms, channels, segments)
      integer(c_int), intent(out) :: status
      integer :: n, failed
      n = size(breaks)
      call check_place(set, number, size(linear, 2), status)
      if (status /= status_ok) return
      status = status_invalid_argument
      if (n < 2 .or. size(linear, 3) /= n - 1 .or. size(harmonic, 4) /= n - 1) return
      if (size(harmonic, 3) /= size(linear, 2)) return
      if (.not. all(breaks(2:) > breaks(:n - 1))) return
      status = status_not_finite
      if (.not. (all(abs(breaks) <= huge(1.0_wp)) .and. all(abs(linear) <= huge(1.0_wp)) &
                 .and. all(abs(harmonic) <= huge(1.0_wp)))) return
      status = status_out_of_memory
      set%item(number) = motion()
      associate (entry => set%item(number))
         allocate (entry%linear(2, size(linear, 2), n - 1), stat=failed)
         if (failed /= 0) return
         allocate (entry%harmonic(4, size(harmonic, 2), size(linear, 2), n - 1), stat=failed)
         if (failed /= 0) return
         entry%linear(:, :, :) = linear
         entry%harmonic(:, :, :, :) = harmonic
         ! The breaks come last: a motion without them does not count as given.
         allocate (entry%breaks(n), stat=failed)
         if (failed /= 0) return
         entry%breaks(:) = breaks
      end associate
      status = status_ok
   end subroutine set_pieces

   !> Motion `number`, scaled, as the integrators read it; it points into the set
   subroutine motion_signal(set, number, scale, ground, status)
      type(motion_set), intent(in), target :: set
      integer(c_int), intent(in) :: number           !! 1-based
      real(wp), intent(in) :: scale                  !! factor on every value
      type(signal), intent(out) :: ground
      integer(c_int), intent(out) :: status
      status = status_bad_index
      if (number < 1 .or. number > size(set%item)) return
      associate (entry => set%item(number))
         status = status_ok
         if (allocated(entry%samples)) then
            ground = signal_sampled(entry%start, entry%step, entry%samples, scale)
         else if (allocated(entry%breaks)) then
            ground = signal_piecewise(entry%breaks, entry%linear, entry%harmonic, scale)
         else
            status = status_not_ready
         end if
      end associate
   end subroutine motion_signal

   pure subroutine check_place(set, number, channels, status)
      type(motion_set), intent(in) :: set
      integer(c_int), intent(in) :: number
      integer, intent(in) :: channels
      integer(c_int), intent(out) :: status
      status = status_ok
      if (channels < 1 .or. channels > most_channels) status = status_invalid_argument
      if (number < 1 .or. number > size(set%item)) status = status_bad_index
   end subroutine check_place

end module common_motion_set
