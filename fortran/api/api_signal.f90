!> Ground motions behind one handle: made with room for a number of motions, then filled one by one.
module api_signal
   use, intrinsic :: iso_c_binding, only : c_double, c_int, c_int64_t
   implicit none
   private
   public :: create, samples, pieces

contains

   !> Room for `count` motions
   subroutine create(count, handle, status)
      use common_motion_set, only : motion_set_new
      integer(c_int), intent(in) :: count
      integer(c_int64_t), intent(out) :: handle
      integer(c_int), intent(out) :: status
      call motion_set_new(count, handle, status)
   end subroutine create

   !> One motion by samples at equal steps, joined by straight lines
   subroutine samples(handle, number, start, step, channels, points, value, status)
      use common_handles, only : handle_leave
      use common_motion_set, only : motion_set, motion_set_take, set_samples
      use common_status, only : status_ok
      integer(c_int64_t), intent(in) :: handle
      integer(c_int), intent(in) :: number                   !! 1-based
      real(c_double), intent(in) :: start                    !! time of the first sample [s]
      real(c_double), intent(in) :: step                     !! [s]
      integer(c_int), intent(in) :: channels                 !! 1 horizontal, 2 with vertical
      integer(c_int), intent(in) :: points
      real(c_double), intent(in) :: value(channels, points)  !! [m/s^2]
      integer(c_int), intent(out) :: status
      type(motion_set), pointer :: set
      call motion_set_take(handle, .true., set, status)
      if (status /= status_ok) return
      call set_samples(set, number, start, step, value, status)
      call handle_leave(handle)
   end subroutine samples

   !> One motion by straight lines and sines between breaks
   subroutine pieces(handle, number, segments, channels, terms, breaks, linear, harmonic, status)
      use common_handles, only : handle_leave
      use common_motion_set, only : motion_set, motion_set_take, set_pieces
      use common_status, only : status_ok
      integer(c_int64_t), intent(in) :: handle
      integer(c_int), intent(in) :: number                   !! 1-based
      integer(c_int), intent(in) :: segments
      integer(c_int), intent(in) :: channels                 !! 1 horizontal, 2 with vertical
      integer(c_int), intent(in) :: terms                    !! sines on each segment
      real(c_double), intent(in) :: breaks(segments + 1)     !! ascending [s]
      !> Value [m/s^2] and slope [m/s^3] at the start of the segment
      real(c_double), intent(in) :: linear(2, channels, segments)
      !> (a + b tau) sin(w tau + phi), tau from the segment's start: a [m/s^2], b [m/s^3], w [rad/s], phi
      real(c_double), intent(in) :: harmonic(4, terms, channels, segments)
      integer(c_int), intent(out) :: status
      type(motion_set), pointer :: set
      call motion_set_take(handle, .true., set, status)
      if (status /= status_ok) return
      call set_pieces(set, number, breaks, linear, harmonic, status)
      call handle_leave(handle)
   end subroutine pieces

end module api_signal
