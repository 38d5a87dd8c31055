!> Discrete elements: one run from rest under gravity to the end of the motion.
module api_dem
   use, intrinsic :: iso_c_binding, only : c_double, c_int
   implicit none
   private
   public :: run

contains

   !> Settle, shake, record. Body numbers are 1-based; mass 0 marks a support.
   subroutine run(nb, npart, nvert, nlaw, ntable, nmove, centroid, mass, inertia, owner, first, vertex, outer, &
                  start_shift, start_rate, law, table_first, table_body, table_law, move_body, move, &
                  sampled, channels, npoint, start, step, samples, nbreak, terms, breaks, linear, harmonic, scale, &
                  moving_base, gravity, mass_damping, limits, domain, settle_steps, stop_at_rest, threads, &
                  nt, wanted, room, time, place, rate, energy, counts, measures, bounces, airborne, settled, &
                  contact_body, contact, status)
      use common_signal, only : signal_sampled, signal_piecewise
      use common_status, only : status_ok, status_invalid_argument, status_out_of_memory
      use dem_bodies, only : body_set_new, body_turn
      use dem_contacts, only : overlap, measure
      use dem_law, only : joint_law
      use dem_loading, only : support_move
      use dem_model, only : model
      use dem_run, only : run_options, run_record, run_model
      integer(c_int), intent(in) :: nb                        !! bodies
      integer(c_int), intent(in) :: npart                     !! convex parts
      integer(c_int), intent(in) :: nvert                     !! vertices of all parts
      integer(c_int), intent(in) :: nlaw                      !! joint types; the first is that of new contacts
      integer(c_int), intent(in) :: ntable                    !! joints with a type of their own
      integer(c_int), intent(in) :: nmove                     !! support movements
      real(c_double), intent(in) :: centroid(2, nb)           !! [m]
      real(c_double), intent(in) :: mass(nb)                  !! [kg]
      real(c_double), intent(in) :: inertia(nb)               !! [kg m^2]
      integer(c_int), intent(in) :: owner(npart)              !! body of each part
      integer(c_int), intent(in) :: first(npart + 1)          !! first vertex of each part
      real(c_double), intent(in) :: vertex(2, nvert)          !! [m]
      integer(c_int), intent(in) :: outer(nvert)              !! 1: the edge that starts here is on the outline
      real(c_double), intent(in) :: start_shift(3, nb)        !! x, y [m], rotation [rad]
      real(c_double), intent(in) :: start_rate(3, nb)         !! [m/s, rad/s]
      real(c_double), intent(in) :: law(6, nlaw)              !! see joint_law
      integer(c_int), intent(in) :: table_first(nb + 1)       !! row of each body in the table
      integer(c_int), intent(in) :: table_body(ntable)        !! the higher body of the joint
      integer(c_int), intent(in) :: table_law(ntable)         !! its type
      integer(c_int), intent(in) :: move_body(nmove)          !! support that moves
      real(c_double), intent(in) :: move(5, nmove)            !! dx, dy [m], turn [rad], start, duration [s]
      integer(c_int), intent(in) :: sampled                   !! 1: samples, 0: pieces
      integer(c_int), intent(in) :: channels                  !! 1 horizontal, 2 with vertical
      integer(c_int), intent(in) :: npoint
      real(c_double), intent(in) :: start                     !! [s]
      real(c_double), intent(in) :: step                      !! [s]
      real(c_double), intent(in) :: samples(channels, npoint)  !! [m/s^2]
      integer(c_int), intent(in) :: nbreak
      integer(c_int), intent(in) :: terms
      real(c_double), intent(in) :: breaks(nbreak)            !! [s]
      real(c_double), intent(in) :: linear(2, channels, nbreak)
      real(c_double), intent(in) :: harmonic(4, terms, channels, nbreak)
      real(c_double), intent(in) :: scale
      integer(c_int), intent(in) :: moving_base               !! 1: the supports move, 0: body force
      real(c_double), intent(in) :: gravity(2)                !! [m/s^2]
      real(c_double), intent(in) :: mass_damping              !! alpha [1/s]
      real(c_double), intent(in) :: limits(6)                 !! see run_options, in its order without domain
      real(c_double), intent(in) :: domain(4)                 !! left, right, bottom, top [m]
      integer(c_int), intent(in) :: settle_steps              !! at most; 0: no settling
      integer(c_int), intent(in) :: stop_at_rest              !! 1: end once all is quiet
      integer(c_int), intent(in) :: threads
      integer(c_int), intent(in) :: nt
      real(c_double), intent(in) :: wanted(nt)                !! output times [s]
      integer(c_int), intent(in) :: room                      !! for contact points of the last step
      real(c_double), intent(out) :: time(nt)                 !! [s]
      real(c_double), intent(out) :: place(3, nb, nt)         !! x, y [m], rotation [rad]
      real(c_double), intent(out) :: rate(3, nb, nt)          !! [m/s, rad/s]
      real(c_double), intent(out) :: energy(9, nt)            !! [J], see energy_terms
      !> points, reason, blamed (2), settling, searches, pairs, steps, contacts
      integer(c_int), intent(out) :: counts(9)
      real(c_double), intent(out) :: measures(4)              !! least step, critical step, stop time [s], residual
      integer(c_int), intent(out) :: bounces(nb)
      real(c_double), intent(out) :: airborne(nb)             !! [s]
      real(c_double), intent(out) :: settled(3, nb)           !! place after settling
      integer(c_int), intent(out) :: contact_body(2, room)
      !> x, y [m], force on the second body x, y [N], normal, shear [N]
      real(c_double), intent(out) :: contact(6, room)
      integer(c_int), intent(out) :: status
      !f2py threadsafe
      call with_targets(samples, breaks, linear, harmonic, wanted, time, place, rate, energy)

   contains

      !> The arrays as pointer targets for the length of the call
      subroutine with_targets(values, edges, lines, sines, times, reached, places, rates, energies)
         real(c_double), intent(in), target, contiguous :: values(:, :), edges(:), lines(:, :, :)
         real(c_double), intent(in), target, contiguous :: sines(:, :, :, :), times(:)
         real(c_double), intent(out), target, contiguous :: reached(:), places(:, :, :), rates(:, :, :), energies(:, :)
         type(model), allocatable :: it
         type(run_options) :: options
         type(run_record) :: record
         integer :: k, failed

         reached = 0.0_c_double
         places = 0.0_c_double
         rates = 0.0_c_double
         energies = 0.0_c_double
         counts = 0
         measures = 0.0_c_double
         bounces = 0
         airborne = 0.0_c_double
         settled = 0.0_c_double
         contact_body = 0
         contact = 0.0_c_double
         status = status_out_of_memory
         allocate (it, stat=failed)
         if (failed /= 0) return
         call body_set_new(centroid, mass, inertia, owner, first, vertex, outer, it%set, status)
         if (status /= status_ok) return
         status = status_out_of_memory
         allocate (it%law(nlaw), it%load%move(nmove), it%contacts%law_first(nb + 1), &
            it%contacts%law_body(ntable), it%contacts%law_number(ntable), stat=failed)
         if (failed /= 0) return
         status = status_invalid_argument
         if (any(table_law < 1) .or. any(table_law > nlaw) .or. table_first(nb + 1) > ntable + 1) return
         do k = 1, nlaw
            it%law(k) = joint_law(law(1, k), law(2, k), law(3, k), law(4, k), law(5, k), law(6, k))
         end do
         it%contacts%law_first(:) = table_first
         it%contacts%law_body(:) = table_body
         it%contacts%law_number(:) = table_law
         do k = 1, nmove
            it%load%move(k) = support_move(int(move_body(k)), move(1:3, k), move(4, k), move(5, k))
         end do
         it%set%item%x = it%set%item%x + start_shift(1, :)
         it%set%item%y = it%set%item%y + start_shift(2, :)
         it%set%item%angle = start_shift(3, :)
         call body_turn(it%set%item)
         it%set%item%vx = start_rate(1, :)
         it%set%item%vy = start_rate(2, :)
         it%set%item%spin = start_rate(3, :)
         it%load%gravity = gravity
         it%load%moving_base = moving_base /= 0
         if (sampled /= 0) then
            it%load%ground = signal_sampled(start, step, values, scale)
         else
            it%load%ground = signal_piecewise(edges, lines(:, :, 1:nbreak - 1), sines(:, :, :, 1:nbreak - 1), scale)
         end if
         it%mass_damping = mass_damping
         options = run_options(limits(1), limits(2), limits(3), limits(4), int(settle_steps), limits(5), domain, &
            limits(6), stop_at_rest /= 0, int(threads))
         record%wanted => times
         record%time => reached
         record%place => places
         record%rate => rates
         record%energy => energies
         call run_model(it, options, record, status)
         counts(1:8) = [int(record%points, c_int), record%reason, int(record%blamed, c_int), &
            int(record%settling, c_int), int(record%searches, c_int), &
            int(max(record%most_pairs, it%contacts%pairs), c_int), &
            int(it%steps, c_int)]
         measures = [record%least_step, record%critical, record%stop_time, record%residual]
         bounces = int(it%set%item%bounces, c_int)
         airborne = it%set%item%airborne
         settled(1, :) = it%set%item%rest_x
         settled(2, :) = it%set%item%rest_y
         settled(3, :) = it%set%item%rest_angle
         call last_contacts(it)
      end subroutine with_targets

      !> Contact points that are closed at the end
      subroutine last_contacts(it)
         type(model), intent(in) :: it
         type(overlap) :: now
         integer :: k, i, n
         real(c_double) :: normal, shear
         n = 0
         do k = 1, it%contacts%pairs
            associate (pair => it%contacts%pair(k))
               call measure(pair, it%set%item(pair%bodies(1)), it%set%item(pair%bodies(2)), now)
               do i = 1, 2
                  if (.not. pair%point(i)%closed .or. n == room) cycle
                  n = n + 1
                  normal = pair%point(i)%spring_n + pair%point(i)%dash_n
                  shear = pair%point(i)%spring_s + pair%point(i)%dash_s
                  contact_body(:, n) = int(pair%bodies, c_int)
                  contact(:, n) = [now%x(i), now%y(i), normal * now%ty(i) + shear * now%tx(i), &
                     shear * now%ty(i) - normal * now%tx(i), normal, shear]
               end do
            end associate
         end do
         counts(9) = int(n, c_int)
      end subroutine last_contacts

   end subroutine run

end module api_dem
