!> Sets of generated earthquakes: motion k of a set is the same whatever the batch or the number of threads.
module motion_generator
   use, intrinsic :: iso_c_binding, only : c_int, c_int64_t
   use common_cancel, only : cancel_requested
   use common_kinds, only : wp
   use common_status, only : status_ok, status_cancelled, status_invalid_argument, status_out_of_memory
   use motion_c_bindings, only : extrados_line_table, extrados_line_motion
   implicit none
   private
   public :: generate_motions

contains

   !> Motions first .. first + count - 1 of the set `seed`
   subroutine generate_motions(line, amplitude, step, envelope, seed, first, threads, motions, status)
      real(wp), intent(in), contiguous :: line(:)             !! frequencies [Hz]
      real(wp), intent(in), contiguous :: amplitude(:)        !! of the sines, same unit as the motions
      real(wp), intent(in) :: step                            !! [s]
      real(wp), intent(in), contiguous :: envelope(:)         !! (points)
      integer(c_int64_t), intent(in) :: seed
      integer(c_int64_t), intent(in) :: first                 !! 0-based
      integer(c_int), intent(in) :: threads
      real(wp), intent(out), contiguous :: motions(:, :)      !! (points, count)
      integer(c_int), intent(out) :: status
      real(wp), allocatable :: table(:)
      integer(c_int), allocatable :: fate(:)
      integer(c_int) :: lines, points
      integer :: k, stat

      motions = 0.0_wp
      status = status_invalid_argument
      if (threads < 1 .or. size(amplitude) /= size(line) .or. size(motions, 1) /= size(envelope)) return
      lines = size(line, kind=c_int)
      points = size(envelope, kind=c_int)
      status = status_out_of_memory
      allocate (table(2_c_int64_t * lines * points), fate(size(motions, 2)), stat=stat)
      if (stat /= 0) return
      status = extrados_line_table(lines, line, points, step, envelope, table)
      if (status /= status_ok) return
      fate = status_cancelled
      !$omp parallel do schedule(static) default(none) num_threads(threads) private(k) &
      !$omp shared(motions, fate, seed, first, lines, amplitude, points, table)
      do k = 1, size(motions, 2)
         if (cancel_requested()) cycle
         fate(k) = extrados_line_motion(seed, first + int(k - 1, c_int64_t), lines, amplitude, points, table, &
            motions(:, k))
      end do
      !$omp end parallel do
      if (size(fate) > 0) status = maxval(fate)
   end subroutine generate_motions

end module motion_generator
