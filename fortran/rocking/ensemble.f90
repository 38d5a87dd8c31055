!> Many independent responses at once: every pair of structure and motion is one run.
module rocking_ensemble
   use common_kinds, only : wp
   use common_cancel, only : cancel_requested
   use common_signal, only : signal, signal_sampled, signal_piecewise
   use common_status, only : status_ok, status_cancelled, status_invalid_argument, status_out_of_memory
   use rocking_arch_rocker, only : arch_rocker, arch_rocker_new
   use rocking_block_rocker, only : block_rocker, block_rocker_new
   use rocking_response, only : respond, response, response_options
   use rocking_rocker, only : rocker
   use rocking_table_rocker, only : table_rocker, table_rocker_new
   use, intrinsic :: iso_c_binding, only : c_int
   implicit none
   private
   public :: motion_set, body_arch, body_block, body_table, make_body, make_motion, run_ensemble

   !> Kinds of rocking structure, as the facades number them
   integer(c_int), parameter :: body_arch = 1, body_block = 2, body_table = 3

   !> Room for one structure of any kind
   type :: any_body
      class(rocker), allocatable :: it
      integer(c_int) :: status = status_ok
   end type any_body

   !> Ground motions stored one behind the other in flat arrays
   type :: motion_set
      integer(c_int), pointer, contiguous :: sampled(:) => null()   !! 1: samples, 0: pieces
      integer(c_int), pointer, contiguous :: first(:) => null()     !! first sample or break, 1-based
      integer(c_int), pointer, contiguous :: segments(:) => null()  !! number of segments
      real(wp), pointer, contiguous :: start(:) => null()           !! [s], sampled motions
      real(wp), pointer, contiguous :: step(:) => null()            !! [s], sampled motions
      real(wp), pointer, contiguous :: samples(:, :) => null()      !! (channels, points) [m/s^2]
      real(wp), pointer, contiguous :: breaks(:) => null()          !! [s]
      !> (2, channels, breaks): the entry of a motion's last break is not used
      real(wp), pointer, contiguous :: linear(:, :, :) => null()
      real(wp), pointer, contiguous :: harmonic(:, :, :, :) => null()  !! (4, terms, channels, breaks)
   end type motion_set

contains

   !> Motion k of the set, scaled
   function make_motion(set, k, scale) result(ground)
      type(motion_set), intent(in) :: set
      integer, intent(in) :: k
      real(wp), intent(in) :: scale
      type(signal) :: ground
      integer :: first, last
      first = set%first(k)
      last = first + set%segments(k)
      if (set%sampled(k) /= 0) then
         ground = signal_sampled(set%start(k), set%step(k), set%samples(:, first:last), scale)
      else
         ground = signal_piecewise(set%breaks(first:last), set%linear(:, :, first:last - 1), &
            set%harmonic(:, :, :, first:last - 1), scale)
      end if
   end function make_motion

   !> A rocking structure from its flat parameter list
   subroutine make_body(kind, parameters, body, status)
      integer(c_int), intent(in) :: kind
      real(wp), intent(in) :: parameters(:)
      class(rocker), allocatable, intent(out) :: body
      integer(c_int), intent(out) :: status
      type(arch_rocker), allocatable :: arch
      type(block_rocker), allocatable :: stone
      type(table_rocker), allocatable :: tabulated
      integer :: stat

      select case (kind)
      case (body_arch)
         allocate (arch, stat=stat)
         if (stat /= 0) then
            status = status_out_of_memory
            return
         end if
         call arch_rocker_new(parameters, arch, status)
         call move_alloc(arch, body)
      case (body_block)
         allocate (stone, stat=stat)
         if (stat /= 0) then
            status = status_out_of_memory
            return
         end if
         call block_rocker_new(parameters, stone, status)
         call move_alloc(stone, body)
      case (body_table)
         allocate (tabulated, stat=stat)
         if (stat /= 0) then
            status = status_out_of_memory
            return
         end if
         call table_rocker_new(parameters, tabulated, status)
         call move_alloc(tabulated, body)
      case default
         status = status_invalid_argument
      end select
   end subroutine make_body

   !> Run all members; the result of a member does not depend on the others or on the threads
   subroutine run_ensemble(kind, bodies, set, run_body, run_motion, run_scale, options, threads, &
                           answers, run_status, status)
      integer(c_int), intent(in) :: kind(:)           !! (nbody)
      real(wp), intent(in) :: bodies(:, :)            !! (parameters, nbody)
      type(motion_set), intent(in) :: set
      integer(c_int), intent(in) :: run_body(:)       !! (nrun), 1-based
      integer(c_int), intent(in) :: run_motion(:)     !! (nrun), 1-based
      real(wp), intent(in) :: run_scale(:)            !! (nrun)
      type(response_options), intent(in) :: options(:)  !! (nrun)
      integer(c_int), intent(in) :: threads
      type(response), intent(out) :: answers(:)
      integer(c_int), intent(out) :: run_status(:)    !! per member; cancelled members were not run
      integer(c_int), intent(out) :: status
      type(any_body), allocatable :: built(:)
      type(signal) :: ground
      integer :: k, stat

      run_status = status_cancelled
      allocate (built(size(kind)), stat=stat)
      if (stat /= 0) then
         status = status_out_of_memory
         return
      end if
      !$omp parallel default(none) num_threads(threads) private(k, ground) &
      !$omp shared(kind, bodies, set, run_body, run_motion, run_scale, options, answers, run_status, built)
      !$omp do schedule(dynamic)
      do k = 1, size(kind)
         call make_body(kind(k), bodies(:, k), built(k)%it, built(k)%status)
      end do
      !$omp end do
      !$omp do schedule(dynamic)
      do k = 1, size(run_body)
         if (cancel_requested()) cycle
         run_status(k) = built(run_body(k))%status
         if (run_status(k) /= status_ok) cycle
         ground = make_motion(set, int(run_motion(k)), run_scale(k))
         call respond(built(run_body(k))%it, ground, options(k), answers(k), run_status(k))
      end do
      !$omp end do
      !$omp end parallel
      status = merge(status_cancelled, status_ok, any(run_status == status_cancelled))
   end subroutine run_ensemble

end module rocking_ensemble
